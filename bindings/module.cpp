#include <pybind11/pybind11.h>

#include "common.hpp"

PYBIND11_MODULE(_core, m) {
  m.doc() = "The C++ library, as it runs on nodes and hub. Private: use the modules of echofuse instead.";
  echofuse::bindings::bind_core(m);
  echofuse::bindings::bind_signal(m);
  echofuse::bindings::bind_estimation(m);
  echofuse::bindings::bind_node(m);
  echofuse::bindings::bind_node_through_wall(m);
  echofuse::bindings::bind_node_through_wall_pipeline(m);
  echofuse::bindings::bind_hub(m);
  echofuse::bindings::bind_link(m);
}
