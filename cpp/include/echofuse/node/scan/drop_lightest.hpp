#pragma once

#include <cstddef>

#include "echofuse/core/bounded_vector.hpp"

namespace echofuse::node {

/// Drops the element of least weight, the last of equals. What a report cannot hold goes that way.
template <class Echo>
void drop_lightest(BoundedVector<Echo>& echoes) {
  std::size_t lightest = 0;
  for (std::size_t i = 1; i < echoes.size(); ++i)
    if (echoes[i].weight <= echoes[lightest].weight) lightest = i;
  if (!echoes.empty()) echoes.erase_at(lightest);
}

}  // namespace echofuse::node
