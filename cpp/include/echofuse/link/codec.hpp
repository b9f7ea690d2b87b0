#pragma once

#include <cstddef>
#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/link/frame.hpp"
#include "echofuse/link/messages.hpp"

/// Payloads of the messages in cpp/dsdl, by the code generated from there. encode(): the payload's length in `out`,
/// 0 when it has no room. decode(): kInvalidInput for a payload that is none of this type, or of our own messages is
/// cut short; the message is then empty.
namespace echofuse::link {

/// Node and frame travel in the header: as its source, and as its transfer id (Detections::frame).
TransferHeader header_of(const Detections& report, std::uint16_t subject);

std::size_t encode(const Detections& report, Span<std::uint8_t> out);
Status decode(const TransferHeader& header, Span<const std::uint8_t> payload, Detections& report);

/// Tracks of a planar hub: what is of z is not sent, and 0 when it is read.
std::size_t encode(const Tracks& tracks, Span<std::uint8_t> out);
Status decode(Span<const std::uint8_t> payload, Tracks& tracks);

/// SpatialTracks, of a hub that locates in three dimensions.
std::size_t encode_spatial(const Tracks& tracks, Span<std::uint8_t> out);
Status decode_spatial(Span<const std::uint8_t> payload, Tracks& tracks);

std::size_t encode(const NodeHealth& health, Span<std::uint8_t> out);
Status decode(Span<const std::uint8_t> payload, NodeHealth& health);

std::size_t encode(const Heartbeat& heartbeat, Span<std::uint8_t> out);
Status decode(Span<const std::uint8_t> payload, Heartbeat& heartbeat);

/// uavcan.time.Synchronization: when the message before this one was sent, 0 unknown. [us]
std::size_t encode_synchronization(std::uint64_t previous_us, Span<std::uint8_t> out);
Status decode_synchronization(Span<const std::uint8_t> payload, std::uint64_t& previous_us);

/// A scan's samples, (n_samples,) [count], into `samples`, and when it was taken. n_samples: as sent; what exceeds
/// `samples` is left out. Not by generated code, which would keep a second copy of the longest scan in memory.
std::size_t encode_raw_scan(std::int64_t time_us, Span<const float> samples, Span<std::uint8_t> out);
Status decode_raw_scan(Span<const std::uint8_t> payload, std::int64_t& time_us, Span<float> samples,
                       std::size_t& n_samples);

/// The part of a tap's `values` that begins at `offset`; at most kTapValues of them. scan: which one.
inline constexpr std::size_t kTapValues = 240;
std::size_t encode_tap(TapId tap, std::uint32_t scan, Span<const float> values, std::size_t offset,
                       Span<std::uint8_t> out);

}  // namespace echofuse::link
