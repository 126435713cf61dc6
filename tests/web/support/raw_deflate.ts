/** Node 18 (Debian 12) lacks raw deflate in its web streams, which every browser has: there its zlib stands in for it. */
import { Duplex } from "node:stream";
import { createDeflateRaw, createInflateRaw } from "node:zlib";

function lacksRawDeflate(): boolean {
  try {
    new DecompressionStream("deflate-raw");
    return false;
  } catch {
    return true;
  }
}

if (lacksRawDeflate()) {
  Object.assign(globalThis, {
    DecompressionStream: function () { return Duplex.toWeb(createInflateRaw()); },
    CompressionStream: function () { return Duplex.toWeb(createDeflateRaw()); },
  });
}
