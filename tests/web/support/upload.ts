/** What the header of a client's frame says. */
export function readHeaderOf(data: Buffer): { id: number; sequence: number; meshes: number } {
  return { id: data.readUInt32LE(4), meshes: data.readUInt32LE(8), sequence: Number(data.readBigUInt64LE(16)) };
}
