/**
 * Greedy meshing: the faces between occupied and empty cells, joined to as few rectangles as a scan finds. Each exposed
 * face is covered exactly once.
 */

/** Rectangles of 6 bytes each: x, y, z of its lowest cell, extents along its two axes (minus nothing), and its face. */
export interface Quads {
  count: number;
  data: Uint8Array;
}
export const QUAD_BYTES = 6;

/** Face numbers: 2 axis + (1 if it looks up the axis). The axes of its extents are (axis + 1) % 3 and (axis + 2) % 3. */
export const faceAxis = (face: number): number => face >> 1;
export const faceLooksUp = (face: number): boolean => (face & 1) === 1;

/**
 * @param cells (size + 2)^3 bytes, x fastest, not 0 where occupied; the outermost layer is the neighbours' and yields no faces.
 * @param size at most 64
 */
export function greedyQuads(cells: Uint8Array, size: number): Quads {
  const padded = size + 2;
  const strides = [1, padded, padded * padded] as const;
  const out = new QuadList();
  const mask = new Uint8Array(size * size);
  for (let face = 0; face < 6; ++face) {
    const axis = faceAxis(face);
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    const [step, stepU, stepV] = [strides[axis]!, strides[u]!, strides[v]!];
    const ahead = faceLooksUp(face) ? step : -step;
    for (let depth = 0; depth < size; ++depth) {
      const origin = (depth + 1) * step + stepU + stepV;
      if (!fillMask(mask, cells, size, origin, stepU, stepV, ahead)) continue;
      joinMask(mask, size, (a, b, width, height) => {
        const at: [number, number, number] = [0, 0, 0];
        at[axis] = depth;
        at[u] = a;
        at[v] = b;
        out.push(at, width, height, face);
      });
    }
  }
  return out.take();
}

/** Marks the exposed faces of one slice; whether there are any. */
function fillMask(mask: Uint8Array, cells: Uint8Array, size: number, origin: number, stepU: number, stepV: number, ahead: number): boolean {
  let any = 0;
  for (let b = 0, to = 0; b < size; ++b) {
    for (let a = 0, from = origin + b * stepV; a < size; ++a, ++to, from += stepU) {
      const exposed = cells[from] !== 0 && cells[from + ahead] === 0 ? 1 : 0;
      mask[to] = exposed;
      any |= exposed;
    }
  }
  return any !== 0;
}

/** Takes all marks off, rectangle by rectangle. */
function joinMask(mask: Uint8Array, size: number, emit: (a: number, b: number, width: number, height: number) => void): void {
  for (let b = 0; b < size; ++b) {
    for (let a = 0; a < size; ++a) {
      const start = b * size + a;
      if (!mask[start]) continue;
      let width = 1;
      while (a + width < size && mask[start + width]) ++width;
      let height = 1;
      while (b + height < size && rowIsFull(mask, start + height * size, width)) ++height;
      for (let row = 0; row < height; ++row) mask.fill(0, start + row * size, start + row * size + width);
      emit(a, b, width, height);
      a += width - 1;
    }
  }
}

function rowIsFull(mask: Uint8Array, start: number, width: number): boolean {
  for (let i = start; i < start + width; ++i) {
    if (!mask[i]) return false;
  }
  return true;
}

class QuadList {
  private data = new Uint8Array(1024 * QUAD_BYTES);
  private count = 0;

  push([x, y, z]: [number, number, number], width: number, height: number, face: number): void {
    const at = this.count++ * QUAD_BYTES;
    if (at + QUAD_BYTES > this.data.length) {
      const larger = new Uint8Array(this.data.length * 2);
      larger.set(this.data);
      this.data = larger;
    }
    this.data[at] = x;
    this.data[at + 1] = y;
    this.data[at + 2] = z;
    this.data[at + 3] = width;
    this.data[at + 4] = height;
    this.data[at + 5] = face;
  }

  take(): Quads {
    return { count: this.count, data: this.data.slice(0, this.count * QUAD_BYTES) };
  }
}

export interface QuadGeometry {
  /** x, y, z in cells from the block's corner and the face, one byte each, four corners a quad. */
  corners: Uint8Array<ArrayBuffer>;
  /** Six a quad; counter-clockwise as seen from outside. */
  indices: Uint32Array<ArrayBuffer>;
}

export function quadGeometry({ count, data }: Quads): QuadGeometry {
  const corners = new Uint8Array(count * 16);
  const indices = new Uint32Array(count * 6);
  for (let quad = 0; quad < count; ++quad) {
    const from = quad * QUAD_BYTES;
    const face = data[from + 5]!;
    const axis = faceAxis(face);
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    for (let corner = 0; corner < 4; ++corner) {
      const to = quad * 16 + corner * 4;
      corners.set(data.subarray(from, from + 3), to);
      corners[to + axis]! += faceLooksUp(face) ? 1 : 0;
      if (corner === 1 || corner === 2) corners[to + u]! += data[from + 3]!;
      if (corner >= 2) corners[to + v]! += data[from + 4]!;
      corners[to + 3] = face;
    }
    const order = faceLooksUp(face) ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
    indices.set(order.map((corner) => quad * 4 + corner), quad * 6);
  }
  return { corners, indices };
}
