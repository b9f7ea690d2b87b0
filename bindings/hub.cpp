#include "common.hpp"

namespace echofuse::bindings {

void bind_hub(py::module_& m) { (void)m; }

}  // namespace echofuse::bindings
