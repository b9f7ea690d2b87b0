#pragma once

#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/hub/track/people_likelihood.hpp"
#include "echofuse/hub/track/range_config.hpp"

namespace echofuse::hub {

/// Somebody who may be there.
struct Candidate {
  const Trail* trail = nullptr;
  bool was_there = false;  ///< after the last frame
};

/// Which of the candidates are there: from those that were, people leave, join or take another's place, one
/// at a time, whatever raises the score of the set most, until nothing does.
/// Reference: python/echofuse/reference/hub/track/people_search.py
class PeopleSearch {
 public:
  static constexpr std::size_t kMaxNewcomers = 8;  ///< tried in a frame, the first ones

  /// The settings are possible (range_config.hpp).
  void configure(const RangeTrackerConfig& config) { config_ = config; }

  /// Fills `there`, one element a candidate; those that were there come first.
  void process(const PeopleLikelihood& likelihood, Span<const Candidate> candidates, Span<bool> there);

 private:
  using Set = BoundedVector<const Trail*, kMaxTargets>;

  float value(const Set& set) const;
  bool improve();
  void try_instead(std::size_t place, const Trail* trail);

  RangeTrackerConfig config_;
  // of the search in work
  const PeopleLikelihood* likelihood_ = nullptr;
  Span<const Candidate> candidates_;
  std::size_t n_before_ = 0;
  Set set_;
  Set tried_;
  float best_value_ = 0.0f;
  std::size_t best_place_ = 0;         ///< in the set, or its size: one more
  const Trail* best_trail_ = nullptr;  ///< who comes there; nullptr: nobody
};

}  // namespace echofuse::hub
