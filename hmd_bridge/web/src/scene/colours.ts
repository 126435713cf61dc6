/** Colours as people know them from the papers, and those of this page. */
export const kSelection = 0x9e1b40; // burgundy
export const kAsset = 0x22d3ee; // cyan
export const kManualLabel = 0xfacc15; // yellow
export const kConflict = 0xff7a1a;
export const kNoGo = 0xef4444;
export const kAllowContact = 0x22c55e;
export const kLease = 0xa78bfa;
export const kMinimap = 0x7dd3fc;
export const kGridFree = 0x2f855a;
export const kGridOccupied = 0x4a5568;
export const kRoom = 0x93c5fd;
export const kBackground = 0x10141b;

const kOthers = [0x60a5fa, 0xf472b6, 0x34d399, 0xfbbf24, 0xc084fc, 0xfb923c, 0x2dd4bf, 0xa3e635];

/** The same colour for the same name, on every device. */
export function colourOf(name: string): number {
  let hash = 0;
  for (const letter of name) hash = (hash * 31 + letter.codePointAt(0)!) >>> 0;
  return kOthers[hash % kOthers.length]!;
}
