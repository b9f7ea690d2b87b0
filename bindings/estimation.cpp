#include "common.hpp"

namespace echofuse::bindings {

void bind_estimation(py::module_& m) { (void)m; }

}  // namespace echofuse::bindings
