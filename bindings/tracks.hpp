#pragma once

#include "common.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::bindings {

void bind_hub_track(py::module_& m);

/// The tracks as a structured array; bind_hub_track registers its dtype.
inline py::array_t<link::Track> to_array(const link::Tracks& tracks) { return to_array(tracks.tracks); }

}  // namespace echofuse::bindings
