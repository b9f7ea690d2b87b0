#include "echofuse/hub/track/people_search.hpp"

#include <algorithm>

#include "echofuse/core/check.hpp"

namespace echofuse::hub {
namespace {

constexpr int kMaxRounds = 8;
constexpr float kLeastGain = 1e-2f;  ///< [1] less is rounding
constexpr std::size_t kNowhere = ~std::size_t{0};

}  // namespace

void PeopleSearch::process(const PeopleLikelihood& likelihood, Span<const Candidate> candidates,
                           Span<bool> there) {
  likelihood_ = &likelihood;
  candidates_ = candidates;
  set_.clear();
  for (const Candidate& candidate : candidates)
    if (candidate.was_there) ECHOFUSE_CHECK(set_.try_push_back(candidate.trail));
  n_before_ = set_.size();
  best_value_ = value(set_);
  for (int round = 0; round < kMaxRounds && improve(); ++round) {
  }
  for (std::size_t i = 0; i < candidates.size(); ++i)
    there[i] = std::find(set_.begin(), set_.end(), candidates[i].trail) != set_.end();
}

/// How well the set explains the window, and how likely it is after the last frame's.
float PeopleSearch::value(const Set& set) const {
  float value = likelihood_->score({set.data(), set.size()});
  const auto size = static_cast<float>(set.size());
  value += config_.lasting_score * static_cast<float>(std::min(set.size(), n_before_));
  value -= config_.newcomer_cost * size;
  for (std::size_t i = 0; i < n_before_; ++i)
    if (std::find(set.begin(), set.end(), candidates_[i].trail) != set.end()) value += config_.identity_score;
  return value;
}

/// Takes the best of all steps from the set; false when none is better.
bool PeopleSearch::improve() {
  best_place_ = kNowhere;
  for (std::size_t place = 0; place < set_.size(); ++place) try_instead(place, nullptr);
  const std::size_t n = std::min(candidates_.size(), n_before_ + kMaxNewcomers);
  for (std::size_t i = 0; i < n; ++i) {
    const Trail* trail = candidates_[i].trail;
    if (std::find(set_.begin(), set_.end(), trail) != set_.end()) continue;
    for (std::size_t place = 0; place <= set_.size(); ++place) try_instead(place, trail);
  }
  if (best_place_ == kNowhere) return false;
  if (best_place_ == set_.size()) {
    ECHOFUSE_CHECK(set_.try_push_back(best_trail_));
  } else if (best_trail_ != nullptr) {
    set_[best_place_] = best_trail_;
  } else {
    set_.erase_at(best_place_);
  }
  return true;
}

void PeopleSearch::try_instead(std::size_t place, const Trail* trail) {
  if (place == set_.capacity()) return;
  tried_.clear();
  for (std::size_t i = 0; i < set_.size(); ++i) {
    const Trail* who = i == place ? trail : set_[i];
    if (who != nullptr) ECHOFUSE_CHECK(tried_.try_push_back(who));
  }
  if (place == set_.size()) ECHOFUSE_CHECK(tried_.try_push_back(trail));
  const float tried = value(tried_);
  const float least = best_place_ == kNowhere ? best_value_ + kLeastGain : best_value_;
  if (!(tried > least)) return;
  best_value_ = tried;
  best_place_ = place;
  best_trail_ = trail;
}

}  // namespace echofuse::hub
