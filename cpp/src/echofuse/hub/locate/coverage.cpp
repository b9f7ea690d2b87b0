#include "echofuse/hub/locate/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/core/constants.hpp"

namespace echofuse::hub {
namespace {

constexpr float kMinCondition = 1e-6f;  ///< det / trace^2; below, the geometry is singular

float from_db(float db) { return std::pow(10.0f, 0.1f * db); }
float to_db(float ratio) { return 10.0f * std::log10(ratio); }
bool positive(float value) { return value > 0.0f && std::isfinite(value); }
bool not_negative(float value) { return value >= 0.0f && std::isfinite(value); }

float distance(const Point& a, const Point& b) {
  return std::sqrt((a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m));
}

/// chi in decibels, for chi itself may leave float32's range on the way.
/// (3) with the two legs' (c / (4 pi f))^2 replaced by 1 / PL of (9):
/// chi = N_s E / N_0 G^2 (4 pi sigma / c^2) mean over the band of f^2 PL_0^-2 (f / f_c)^(-4 (kappa + 1)).
float bistatic_constant_db(const CoverageConfig& c) {
  const float energy_dbj =
      c.transmit_power_dbm - 30.0f + to_db(c.pulse_interval_s) + to_db(static_cast<float>(c.pulses_per_scan));
  const float noise_dbj =
      to_db(kBoltzmann_J_per_K * 1e20f) - 200.0f + to_db(c.noise_temperature_K) + c.noise_figure_db;
  const float wavelength = kSpeedOfLight_mps / c.centre_hz;
  const float free_space_1m_db = 2.0f * to_db(4.0f * kPi / wavelength);
  const float target_db = to_db(4.0f * kPi * c.radar_cross_section_m2 / (wavelength * wavelength));
  const float legs_db = -2.0f * (free_space_1m_db + c.excess_path_loss_1m_db);

  const float power = -2.0f - 4.0f * c.frequency_exponent;  // of f / f_c under the integral
  const float half = 0.5f * c.bandwidth_hz / c.centre_hz;
  const float band = (std::pow(1.0f + half, power + 1.0f) - std::pow(1.0f - half, power + 1.0f)) /
                     (2.0f * half * (power + 1.0f));
  return energy_dbj - noise_dbj + 2.0f * c.antenna_gain_db + target_db + legs_db + to_db(band);
}

}  // namespace

const char* invalid_field(const CoverageConfig& c) {
  if (!std::isfinite(c.transmit_power_dbm)) return "transmit_power_dbm";
  if (!not_negative(c.noise_figure_db)) return "noise_figure_db";
  if (!std::isfinite(c.antenna_gain_db)) return "antenna_gain_db";
  if (!positive(c.centre_hz)) return "centre_hz";
  if (!(c.bandwidth_hz > 0.0f && c.bandwidth_hz < 2.0f * c.centre_hz)) return "bandwidth_hz";
  if (!positive(c.pulse_interval_s)) return "pulse_interval_s";
  if (c.pulses_per_scan < 1) return "pulses_per_scan";
  if (!positive(c.radar_cross_section_m2)) return "radar_cross_section_m2";
  if (!positive(c.noise_temperature_K)) return "noise_temperature_K";
  if (!positive(c.path_loss_exponent)) return "path_loss_exponent";
  if (!not_negative(c.frequency_exponent)) return "frequency_exponent";
  if (!std::isfinite(c.excess_path_loss_1m_db)) return "excess_path_loss_1m_db";
  if (!std::isfinite(c.min_snr_db)) return "min_snr_db";
  if (!not_negative(c.blind_zone_s)) return "blind_zone_s";
  if (!positive(c.path_sigma_m)) return "path_sigma_m";
  if (!(c.body_radius_m >= 0.0f && c.body_radius_m <= 1.0f)) return "body_radius_m";
  return nullptr;
}

float cassini_ratio(float to_tx_m, float to_rx_m, float baseline_m) {
  return std::sqrt(to_tx_m * to_rx_m) / (0.5f * baseline_m);
}

float leg_product_m2(float sum_m, float baseline_m, float bistatic_angle_rad) {
  return (sum_m * sum_m - baseline_m * baseline_m) / (2.0f * (1.0f + std::cos(bistatic_angle_rad)));
}

float snr(float bistatic_constant_m4, float to_tx_m, float to_rx_m) {
  const float product = to_tx_m * to_rx_m;
  return bistatic_constant_m4 / (product * product);
}

float snr_on_ellipse(float bistatic_constant_m4, float sum_m, float baseline_m, float bistatic_angle_rad) {
  const float product = leg_product_m2(sum_m, baseline_m, bistatic_angle_rad);
  return bistatic_constant_m4 / (product * product);
}

float sum_on_cassini_m(float bistatic_constant_m4, float snr, float baseline_m, float bistatic_angle_rad) {
  const float product = max_leg_product_m2(bistatic_constant_m4, snr);
  return std::sqrt(baseline_m * baseline_m + 2.0f * (1.0f + std::cos(bistatic_angle_rad)) * product);
}

float max_leg_product_m2(float bistatic_constant_m4, float min_snr) {
  return std::sqrt(bistatic_constant_m4 / min_snr);
}

float time_of_arrival_s(float to_tx_m, float to_rx_m) { return (to_tx_m + to_rx_m) / kSpeedOfLight_mps; }

Status Coverage::configure(const CoverageConfig& config, Span<const NodeSite> nodes, const Area& area) {
  if (invalid_field(config) != nullptr || invalid_site(nodes, area) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  n_nodes_ = nodes.size();
  std::copy(nodes.begin(), nodes.end(), nodes_.begin());
  bistatic_constant_db_ = bistatic_constant_db(config);
  bistatic_constant_ = from_db(bistatic_constant_db_);
  return Status::kOk;
}

Status Coverage::process(const Point& position, CoveragePoint& result) const {
  result = CoveragePoint{};
  if (n_nodes_ == 0) return Status::kNotConfigured;
  if (invalid_field(position) != nullptr) return Status::kInvalidInput;
  const float none = -std::numeric_limits<float>::infinity();
  std::array<float, 3> best{none, none, none};  // [dB] descending
  float xx = 0.0f;
  float xy = 0.0f;
  float yy = 0.0f;
  for (std::size_t i = 0; i < n_nodes_; ++i) {
    const NodeSite& node = nodes_[i];
    const float to_tx = distance(position, node.tx);
    const float to_rx = distance(position, node.rx);
    const float snr_db = bistatic_constant_db_ - config_.path_loss_exponent * to_db(to_tx * to_rx);
    for (std::size_t rank = 0; rank < best.size(); ++rank) {
      if (!(snr_db > best[rank])) continue;
      for (std::size_t lower = best.size() - 1; lower > rank; --lower) best[lower] = best[lower - 1];
      best[rank] = snr_db;
      break;
    }
    const float excess_m = to_tx + to_rx - distance(node.tx, node.rx);
    if (excess_m < config_.blind_zone_s * kSpeedOfLight_mps) {
      ++result.n_blind;
      continue;
    }
    if (!(snr_db >= config_.min_snr_db)) continue;
    ++result.n_covering;
    Point gradient;
    static_cast<void>(path_length(position, node.tx, node.rx, config_.body_radius_m, &gradient));
    xx += gradient.x_m * gradient.x_m;
    xy += gradient.x_m * gradient.y_m;
    yy += gradient.y_m * gradient.y_m;
  }
  result.best_snr_db = best[0];
  result.third_snr_db = best[2];
  const float trace = xx + yy;
  const float determinant = xx * yy - xy * xy;
  result.position_error_bound_m = determinant > kMinCondition * trace * trace
                                      ? config_.path_sigma_m * std::sqrt(trace / determinant)
                                      : std::numeric_limits<float>::infinity();
  return Status::kOk;
}

}  // namespace echofuse::hub
