#include "echofuse/core/status.hpp"

namespace echofuse {

const char* name(Status status) {
  switch (status) {
    case Status::kOk:
      return "ok";
    case Status::kTruncated:
      return "truncated";
    case Status::kNotConfigured:
      return "not_configured";
    case Status::kInvalidConfig:
      return "invalid_config";
    case Status::kInvalidInput:
      return "invalid_input";
  }
  return "unknown";
}

}  // namespace echofuse
