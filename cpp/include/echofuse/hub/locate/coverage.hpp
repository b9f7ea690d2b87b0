#pragma once

#include <array>
#include <cstddef>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/locate/site.hpp"

namespace echofuse::hub {

struct CoverageConfig {
  float transmit_power_dbm = -12.64f;   ///< [dBm] mean over the inter-pulse period
  float noise_figure_db = 4.8f;         ///< [dB] >= 0
  float antenna_gain_db = 0.0f;         ///< [dB] of each antenna
  float centre_hz = 4.3e9f;             ///< [Hz] > bandwidth / 2
  float bandwidth_hz = 2.2e9f;          ///< [Hz] > 0
  float pulse_interval_s = 117.12e-9f;  ///< [s] > 0
  int pulses_per_scan = 20480;          ///< N_s, integrated coherently, >= 1
  float radar_cross_section_m2 = 1.0f;  ///< [m^2] of a person, > 0
  float noise_temperature_K = 290.0f;   ///< [K] > 0
  float path_loss_exponent = 2.0f;      ///< [1] rho of (9), 2 in free space, > 0
  float frequency_exponent = 0.0f;      ///< [1] kappa of (9), 0 in free space, >= 0
  float excess_path_loss_1m_db = 0.0f;  ///< [dB] PL_0 over free space's at 1 m, each leg
  float min_snr_db = 20.0f;             ///< [dB] SNR_min: what detection needs
  float blind_zone_s = 1.5e-9f;         ///< [s] after the direct path, not searched, >= 0
  float path_sigma_m = 0.05f;           ///< [m] standard deviation of one measured path, > 0
  float body_radius_m = 0.0f;           ///< [m] as in EllipseConfig, in [0, 1]
};

const char* invalid_field(const CoverageConfig& config);

/// A place as the site sees it.
struct CoveragePoint {
  int n_covering = 0;                   ///< pairs with enough SNR that are not blind there
  int n_blind = 0;                      ///< pairs in whose blind zone it lies
  float best_snr_db = 0.0f;             ///< [dB] over all pairs
  float third_snr_db = 0.0f;            ///< [dB] the third best: what a fix depends on
  float position_error_bound_m = 0.0f;  ///< [m] Cramer-Rao, by the covering pairs; infinite if they cannot
};

/// [1] (5): sqrt(l_t l_r) / (l / 2). Under 1 two loops, 1 a lemniscate, over 1 one loop.
float cassini_ratio(float to_tx_m, float to_rx_m, float baseline_m);
/// [m^2] (6): l_t l_r on the ellipse of a sum l_t + l_r, at a bistatic angle.
float leg_product_m2(float sum_m, float baseline_m, float bistatic_angle_rad);
/// [1] (2): chi / (l_t l_r)^2.
float snr(float bistatic_constant_m4, float to_tx_m, float to_rx_m);
/// [1] (7): the SNR on the ellipse of a sum l_t + l_r, at a bistatic angle.
float snr_on_ellipse(float bistatic_constant_m4, float sum_m, float baseline_m, float bistatic_angle_rad);
/// [m] (8): l_t + l_r on the Cassini oval of an SNR, at a bistatic angle.
float sum_on_cassini_m(float bistatic_constant_m4, float snr, float baseline_m, float bistatic_angle_rad);
/// [m^2] (4): the largest l_t l_r with an SNR.
float max_leg_product_m2(float bistatic_constant_m4, float min_snr);
/// [s] the time of arrival after transmission of an echo, (l_t + l_r) / c.
float time_of_arrival_s(float to_tx_m, float to_rx_m);

/// Which pairs see a place, and how well the site can locate a person there (sensor-radar paper, section III;
/// algorithms 6.1 and 8.2). The energy spectrum is flat within the band, and the path loss that of (9).
/// Reference: python/echofuse/reference/hub/locate/coverage.py
class Coverage {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const CoverageConfig& config, Span<const NodeSite> nodes, const Area& area);

  /// kInvalidInput: not finite.
  Status process(const Point& position, CoveragePoint& result) const;

  /// [m^(2 rho)] chi of (3), with (9) in place of free space; 0 until configured.
  float bistatic_constant() const { return bistatic_constant_; }

 private:
  CoverageConfig config_;
  std::array<NodeSite, kMaxNodes> nodes_;
  std::size_t n_nodes_ = 0;
  float bistatic_constant_ = 0.0f;
  float bistatic_constant_db_ = 0.0f;
};

}  // namespace echofuse::hub
