/** A path as a flat band a little above the ground, coloured by how much room there is beside it. Values in, values out. */
import type { PathPoint } from "../../generated/messages";
import { add, normalized, scale, sub, type Vec3 } from "../base/vec";

export interface Ribbon {
  /** x y z of two corners for each point of the path. */
  positions: Float32Array;
  colours: Float32Array;
  indices: number[];
}

const kTight: Vec3 = [0.86, 0.2, 0.16];
const kFair: Vec3 = [0.98, 0.78, 0.2];
const kWide: Vec3 = [0.2, 0.78, 0.45];
const kTightMetres = 0.15;
const kWideMetres = 0.8;

/** Red where it is tight, green where there is room. @param clearance metres */
export function clearanceColour(clearance: number): Vec3 {
  const t = Math.min(1, Math.max(0, (clearance - kTightMetres) / (kWideMetres - kTightMetres)));
  const mix = (a: Vec3, b: Vec3, s: number): Vec3 => add(scale(a, 1 - s), scale(b, s));
  return t < 0.5 ? mix(kTight, kFair, t * 2) : mix(kFair, kWide, t * 2 - 1);
}

/** @param width, lift metres. Fewer than two points give an empty ribbon. */
export function ribbon(points: readonly PathPoint[], width: number, lift: number): Ribbon {
  const positions: number[] = [];
  const colours: number[] = [];
  const indices: number[] = [];
  if (points.length < 2) return { positions: new Float32Array(), colours: new Float32Array(), indices };
  points.forEach(({ p, clearance }, i) => {
    const before = points[Math.max(0, i - 1)]!.p;
    const after = points[Math.min(points.length - 1, i + 1)]!.p;
    const along = normalized(sub(after, before));
    const side = scale(normalized([-along[1], along[0], 0]), width / 2);
    const centre = add(p, [0, 0, lift]);
    positions.push(...add(centre, side), ...sub(centre, side));
    const colour = clearanceColour(clearance);
    colours.push(...colour, ...colour);
    if (i > 0) {
      const [a, b, c, d] = [2 * i - 2, 2 * i - 1, 2 * i, 2 * i + 1];
      indices.push(a, b, c, c, b, d);
    }
  });
  return { positions: Float32Array.from(positions), colours: Float32Array.from(colours), indices };
}
