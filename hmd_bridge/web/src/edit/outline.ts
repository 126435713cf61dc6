/** Edges of shapes, as pairs of points: what a person sees of a selection or a zone. Values in, values out. */
import type { Shape, Volume } from "../../generated/messages";
import { transformed, type Vec3 } from "../base/vec";

export type Edge = [Vec3, Vec3];

const ring = (points: Vec3[]): Edge[] => points.map((p, i) => [p, points[(i + 1) % points.length]!]);

/** Bottom, top, and uprights of something over a ground plan. */
function upright(plan: readonly (readonly [number, number])[], low: number, high: number): Edge[] {
  const bottom = plan.map(([x, y]): Vec3 => [x, y, low]);
  const top = plan.map(([x, y]): Vec3 => [x, y, high]);
  return [...ring(bottom), ...ring(top), ...bottom.map((p, i): Edge => [p, top[i]!])];
}

function boxEdges([x0, y0, z0]: Vec3, [x1, y1, z1]: Vec3): Edge[] {
  return upright([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], z0, z1);
}

export function outline(shape: Shape | Volume, resolution: number): Edge[] {
  switch (shape.kind) {
    case "line":
      return shape.points.slice(1).map((p, i): Edge => [shape.points[i]!, p]);
    case "area":
      return ring(shape.points);
    case "box":
      return boxEdges(shape.min, shape.max);
    case "prism":
      return upright(shape.points, shape.low, shape.high);
    case "oriented_box": {
      const half = shape.size.map((edge) => edge / 2) as Vec3;
      return boxEdges(half.map((h) => -h) as Vec3, half).map(([a, b]): Edge => [transformed(shape.T_frame_box, a), transformed(shape.T_frame_box, b)]);
    }
    case "voxels":
      return shape.boxes.flatMap(([x0, y0, z0, x1, y1, z1]) =>
        boxEdges([x0 * resolution, y0 * resolution, z0 * resolution], [(x1 + 1) * resolution, (y1 + 1) * resolution, (z1 + 1) * resolution]));
  }
}
