#include "common.hpp"

namespace echofuse::bindings {

void bind_node(py::module_& m) { (void)m; }

}  // namespace echofuse::bindings
