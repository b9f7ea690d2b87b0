#include "common.hpp"

namespace echofuse::bindings {

void bind_signal(py::module_& m) { (void)m; }

}  // namespace echofuse::bindings
