#include "protocol/frame.hpp"

#include <zlib.h>

#include <cassert>

namespace concord::hmd {
namespace {

constexpr std::uint8_t kDeflated = 1, kWhole = 2;
constexpr int kEffort = 6;  // of deflate: 9 gains 1 % of a map for twice the time

tl::unexpected<Error> malformed(const char* what) { return refuse(Code::kMalformed, what); }

[[nodiscard]] bool is_kind(std::uint8_t kind) { return (kind >= 1 && kind <= 5) || kind == 65 || kind == 66; }

}  // namespace

Bytes deflate(ByteSpan bytes) {
  z_stream stream{};
  [[maybe_unused]] int status = deflateInit2(&stream, kEffort, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  assert(status == Z_OK);
  Bytes out(deflateBound(&stream, bytes.size()));
  stream.next_in = const_cast<Bytef*>(bytes.data());  // zlib does not write there
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  status = ::deflate(&stream, Z_FINISH);
  assert(status == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

Result<Bytes> inflate(ByteSpan bytes, std::size_t size) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return refuse(Code::kIo, "no memory to inflate a frame");
  Bytes out(size + 1);  // a byte more: what is longer shows, and nothing is no valid place
  stream.next_in = const_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = ::inflate(&stream, Z_FINISH);
  const bool whole = status == Z_STREAM_END && stream.total_out == size && stream.avail_in == 0;
  inflateEnd(&stream);
  if (!whole) return malformed("the payload does not inflate to what the header says");
  out.resize(size);
  return out;
}

Bytes make_frame(const FrameHead& head, const Bytes& payload) {
  const Bytes packed = deflate(payload);
  const bool smaller = packed.size() < payload.size();
  const Bytes& body = smaller ? packed : payload;
  Bytes out;
  out.reserve(kFrameHeader + body.size());
  out.push_back(static_cast<std::uint8_t>(head.kind));
  out.push_back(static_cast<std::uint8_t>((smaller ? kDeflated : 0) | (head.whole ? kWhole : 0)));
  out.push_back(static_cast<std::uint8_t>(head.level));
  out.push_back(0);
  append_le(out, head.stream);
  append_le(out, head.count);
  append_le(out, static_cast<std::uint32_t>(payload.size()));
  append_le(out, head.revision);
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

Result<PackedFrame> read_packed(ByteSpan bytes) {
  if (bytes.size() < kFrameHeader) return malformed("a binary frame begins with a header of 24 bytes");
  const std::uint8_t kind = bytes[0], flags = bytes[1], level = bytes[2];
  if (!is_kind(kind)) return malformed("no kind of frame has this number");
  if ((flags & ~(kDeflated | kWhole)) != 0 || level >= kLevels || bytes[3] != 0)
    return malformed("header bits that mean nothing");
  ByteSpan in = bytes.subspan(4);
  PackedFrame frame;
  frame.deflated = (flags & kDeflated) != 0;
  frame.head.kind = static_cast<FrameKind>(kind);
  frame.head.whole = (flags & kWhole) != 0;
  frame.head.level = level;
  frame.head.stream = *read_le<std::uint32_t>(in);
  frame.head.count = *read_le<std::uint32_t>(in);
  frame.size = *read_le<std::uint32_t>(in);
  frame.head.revision = *read_le<std::int64_t>(in);
  if (frame.head.revision < 0) return malformed("a revision or sequence is not negative");
  if (frame.size > kMaxInflatedBytes) return refuse(Code::kTooLarge, "a payload has at most 16 MiB");
  if (!frame.deflated && in.size() != frame.size) return malformed("the payload is not as long as the header says");
  // Deflate makes at most about 1032 of one byte: what claims more is no payload, and gets no memory.
  if (frame.deflated && frame.size / 1040 > in.size())
    return malformed("the payload cannot inflate to what the header says");
  frame.body.assign(in.begin(), in.end());
  return frame;
}

Result<BinaryFrame> unpack(PackedFrame packed) {
  if (!packed.deflated) return BinaryFrame{packed.head, std::move(packed.body)};
  auto inflated = inflate(packed.body, packed.size);
  if (!inflated) return tl::unexpected(std::move(inflated.error()));
  return BinaryFrame{packed.head, std::move(*inflated)};
}

Result<BinaryFrame> read_frame(ByteSpan bytes) {
  auto packed = read_packed(bytes);
  if (!packed) return tl::unexpected(std::move(packed.error()));
  return unpack(std::move(*packed));
}

}  // namespace concord::hmd
