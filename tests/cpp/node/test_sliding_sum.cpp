#include "echofuse/core/compensated_sum.hpp"
#include "echofuse/node/scan/sliding_sum.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "echofuse/core/random.hpp"
#include "echofuse/node/scan/sorted_window.hpp"

using echofuse::CompensatedSum;
using echofuse::Pcg32;
using echofuse::node::SlidingSum;
using echofuse::node::SortedWindow;

TEST_CASE("a compensated sum of two million tenths is right") {
  CompensatedSum sum;
  float plain = 0.0f;
  for (int i = 0; i < 2000000; ++i) {
    sum.add(0.1f);
    plain += 0.1f;
  }
  CHECK(sum.value() == doctest::Approx(200000.0f).epsilon(1e-6));
  CHECK(plain != doctest::Approx(200000.0f).epsilon(1e-3));  // the test means something
}

TEST_CASE("a sliding sum is the sum of the last values, however loud the earlier ones") {
  Pcg32 random(1, 2);
  for (const std::size_t window : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{64}}) {
    SlidingSum<64> sum(window);
    std::vector<float> values(window, 0.0f);
    for (int i = 0; i < 500; ++i) {
      const float value = i % 97 == 5 ? 1e9f : random.uniform();
      values.push_back(value);
      sum.push(value);
      double expected = 0.0;
      for (std::size_t j = values.size() - window; j < values.size(); ++j)
        expected += static_cast<double>(values[j]);
      CHECK(static_cast<double>(sum.value()) == doctest::Approx(expected).epsilon(2e-6));
    }
  }
}

TEST_CASE("a sorted window stays sorted through every kind of change") {
  Pcg32 random(3, 4);
  SortedWindow<16> window;
  std::vector<float> values;
  const auto draw = [&] { return static_cast<float>(random.next_u32() % 10); };  // with many equals
  for (int i = 0; i < 3000; ++i) {
    const auto place = values.empty() ? 0 : random.next_u32() % values.size();
    switch (random.next_u32() % 3) {
      case 0:
        if (values.size() == 16) break;
        values.push_back(draw());
        window.insert(values.back());
        break;
      case 1:
        if (values.empty()) break;
        window.remove(values[place]);
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(place));
        break;
      default:
        if (values.empty()) break;
        const float value = draw();
        window.replace(values[place], value);
        values[place] = value;
        break;
    }
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    REQUIRE(window.size() == sorted.size());
    for (std::size_t rank = 1; rank <= sorted.size(); ++rank) CHECK(window.ranked(rank) == sorted[rank - 1]);
  }
}
