#include "echofuse/hub/measure/trace_pairing.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/constants.hpp"
#include "echofuse/estimation/assignment.hpp"

namespace echofuse::hub {
namespace {

// Limits lie between the values that differences of whole samples, and of half ones, have.
constexpr float kPairSlack = 0.5f;     ///< [sample]
constexpr float kCentreSlack = 0.25f;  ///< [sample]

using Traces = std::array<float, kMaxDetectionsPerNode>;  ///< [sample]

bool to_samples(Span<const float> delay_s, float clock_hz, Traces& traces) {
  for (std::size_t i = 0; i < delay_s.size(); ++i) {
    traces[i] = delay_s[i] * clock_hz;
    if (!std::isfinite(traces[i])) return false;
  }
  return true;
}

}  // namespace

const char* invalid_field(const TracePairingConfig& config) {
  if (config.rule > PairingRule::kAllPairs) return "rule";
  if (config.closing > ClosingRule::kPrinted) return "closing";
  if (!(config.separation_m > 0.0f && config.separation_m <= 10.0f)) return "separation_m";
  if (!(config.clock_hz > 0.0f && std::isfinite(config.clock_hz))) return "clock_hz";
  if (config.correction_samples < 0 || config.correction_samples > 100) return "correction_samples";
  if (config.completion_limit < 0 || config.completion_limit > 1000) return "completion_limit";
  return nullptr;
}

Status TracePairing::configure(const TracePairingConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  width_ = std::floor(config.separation_m / kSpeedOfLight_mps * config.clock_hz + 0.5f) +
           static_cast<float>(config.correction_samples);
  half_width_ = std::ceil(0.5f * width_);
  reset();
  return Status::kOk;
}

Status TracePairing::process(Span<const float> delay1_s, Span<const float> delay2_s,
                             BoundedVector<TraceCouple>& couples) {
  couples.clear();
  if (half_width_ == 0.0f) return Status::kNotConfigured;
  if (std::max(delay1_s.size(), delay2_s.size()) > kMaxDetectionsPerNode) return Status::kInvalidInput;
  Traces first{}, second{};
  if (!to_samples(delay1_s, config_.clock_hz, first) || !to_samples(delay2_s, config_.clock_hz, second))
    return Status::kInvalidInput;
  const Span<const float> n1(first.data(), delay1_s.size());
  const Span<const float> n2(second.data(), delay2_s.size());
  const bool complete = config_.rule == PairingRule::kAllPairs ? pair_all(n1, n2, couples)
                                                               : pair_by_assignment(n1, n2, couples);
  return complete ? Status::kOk : Status::kTruncated;
}

TraceCouple TracePairing::close(float n1, float n2) const {
  TraceCouple couple;
  couple.centre = 0.5f * (n1 + n2);
  float centre = couple.centre;
  float gap = 0.5f * std::abs(n1 - n2);
  if (config_.closing == ClosingRule::kPrinted) {
    centre -= 1.0f;
    gap = width_ - 0.5f * (2.0f * half_width_ + 1.0f - std::abs(n1 - n2));
  }
  if (n1 > n2) gap = -gap;
  couple.delay1_s = (centre - gap) / config_.clock_hz;
  couple.delay2_s = (centre + gap) / config_.clock_hz;
  return couple;
}

bool TracePairing::pair_all(Span<const float> n1, Span<const float> n2,
                            BoundedVector<TraceCouple>& couples) const {
  for (const float a : n1)
    for (const float b : n2)
      if (std::abs(a - b) <= 2.0f * half_width_ + kPairSlack && !couples.try_push_back(close(a, b)))
        return false;
  return true;
}

bool TracePairing::pair_by_assignment(Span<const float> n1, Span<const float> n2,
                                      BoundedVector<TraceCouple>& couples) {
  const float limit = 2.0f * half_width_ + kPairSlack;
  const float none = limit + 0.5f;
  std::array<int, kMaxDetectionsPerNode> partner{};
  std::fill_n(partner.begin(), n1.size(), estimation::kUnassigned);
  for (std::size_t i = 0; i < n1.size(); ++i) {
    for (std::size_t k = 0; k < n2.size(); ++k) {
      const float apart = std::abs(n1[i] - n2[k]);
      cost_[i * n2.size() + k] = apart <= limit ? apart : none;
    }
  }
  if (!n1.empty() && !n2.empty()) {
    const Status status = estimation::assign({cost_.data(), n1.size() * n2.size()}, n1.size(), n2.size(),
                                             {partner.data(), n1.size()});
    ECHOFUSE_CHECK(status == Status::kOk);
  }
  std::array<bool, kMaxDetectionsPerNode> paired1{}, paired2{};
  bool room = true;
  for (std::size_t i = 0; i < n1.size(); ++i) {
    if (partner[i] == estimation::kUnassigned) continue;
    const auto k = static_cast<std::size_t>(partner[i]);
    if (cost_[i * n2.size() + k] >= none) continue;
    paired1[i] = paired2[k] = true;
    room = couples.try_push_back(close(n1[i], n2[k])) && room;
  }
  const auto goes_on = [&](const TraceCouple& old) {
    if (old.completions >= config_.completion_limit) return true;
    return std::any_of(couples.begin(), couples.end(), [&](const TraceCouple& couple) {
      return std::abs(old.centre - couple.centre) <= half_width_ + kCentreSlack;
    });
  };
  const auto end = std::remove_if(previous_.begin(),
                                  previous_.begin() + static_cast<std::ptrdiff_t>(n_previous_), goes_on);
  n_previous_ = static_cast<std::size_t>(end - previous_.begin());
  for (std::size_t i = 0; i < n1.size(); ++i)
    if (!paired1[i]) room = complete(n1[i], couples) && room;
  for (std::size_t k = 0; k < n2.size(); ++k)
    if (!paired2[k]) room = complete(n2[k], couples) && room;
  n_previous_ = std::min(couples.size(), previous_.size());
  std::copy_n(couples.begin(), n_previous_, previous_.begin());
  return room;
}

/// By the nearest couple of the last response, which is then used up. False when there is no room.
bool TracePairing::complete(float trace, BoundedVector<TraceCouple>& couples) {
  std::size_t best = n_previous_;
  float least = half_width_ + kCentreSlack;
  for (std::size_t i = 0; i < n_previous_; ++i) {
    const float apart = std::abs(previous_[i].centre - trace);
    if (!(best == n_previous_ ? apart <= least : apart < least)) continue;
    least = apart;
    best = i;
  }
  if (best == n_previous_) return true;
  TraceCouple copy = previous_[best];
  ++copy.completions;
  for (std::size_t i = best + 1; i < n_previous_; ++i) previous_[i - 1] = previous_[i];
  --n_previous_;
  return couples.try_push_back(copy);
}

}  // namespace echofuse::hub
