/** What a person has selected so far, point by point, and the shape that it amounts to. Values in, values out. */
import type { Shape, Volume } from "../../generated/messages";
import { add, cross, distance, dot, normalized, scale, sub, type Vec3 } from "../base/vec";

export type Tool = "line" | "area" | "box" | "prism";

export interface Selection {
  tool: Tool;
  /** Metres, in the frame that is edited; the last may still be moving. */
  points: Vec3[];
  /** No more points come. */
  closed: boolean;
  /** Of lines and areas, metres. */
  thickness: number;
  /** Of boxes and prisms above their lowest point, metres; null takes it from the points. */
  height: number | null;
}

export const kTools: readonly { tool: Tool; title: string; hint: string }[] = [
  { tool: "line", title: "Line", hint: "Click the points of the line. Enter or a double click ends it." },
  { tool: "area", title: "Area", hint: "Click the corners of a flat area, such as a pane of glass. Enter or a double click ends it." },
  { tool: "box", title: "Box", hint: "Click two opposite corners on the ground. The height is set beside." },
  { tool: "prism", title: "Prism", hint: "Click the corners of its ground plan. Enter or a double click ends it." },
];

const kMostPoints = 1024;
const kLeastPoints: Record<Tool, number> = { line: 2, area: 3, box: 2, prism: 3 };

export function begun(tool: Tool, thickness: number, height: number | null): Selection {
  return { tool, points: [], closed: false, thickness, height };
}

/** A point more; a box is closed by its second. Points that repeat the last one, or come after the end, change nothing. */
export function withPoint(selection: Selection, point: Vec3): Selection {
  const { tool, points } = selection;
  const last = points.at(-1);
  if (selection.closed || points.length >= kMostPoints || (last && distance(last, point) < 1e-6)) return selection;
  return { ...selection, points: [...points, point], closed: tool === "box" && points.length === 1 };
}

/** Ends it, if it has points enough to be something. */
export function ended(selection: Selection): Selection {
  return selection.points.length >= kLeastPoints[selection.tool] ? { ...selection, closed: true } : selection;
}

export function withoutLast(selection: Selection): Selection {
  return { ...selection, points: selection.points.slice(0, -1), closed: false };
}

/** What it would be if it ended here; null while it is too little. */
export function shapeOf(selection: Selection): Shape | null {
  const { tool, points, thickness } = selection;
  if (points.length < kLeastPoints[tool]) return null;
  if (tool === "line") return { kind: "line", points, thickness };
  if (tool === "area") return { kind: "area", points: flattened(points), thickness };
  return volumeOf(selection);
}

/** Of a box or a prism; null for what has no volume. */
export function volumeOf({ tool, points, height }: Selection): Volume | null {
  if (points.length < kLeastPoints[tool] || (tool !== "box" && tool !== "prism")) return null;
  const low = Math.min(...points.map((p) => p[2]));
  const high = height === null ? Math.max(...points.map((p) => p[2])) : low + height;
  if (!(high > low)) return null;
  if (tool === "prism") return { kind: "prism", points: points.map(([x, y]) => [x, y]), low, high };
  const [a, b] = [points[0]!, points[1]!];
  if (a[0] === b[0] || a[1] === b[1]) return null;
  return { kind: "box", min: [Math.min(a[0], b[0]), Math.min(a[1], b[1]), low], max: [Math.max(a[0], b[0]), Math.max(a[1], b[1]), high] };
}

/** The corners moved into one plane: the one through their mean with the normal of Newell's method. */
export function flattened(points: Vec3[]): Vec3[] {
  let normal: Vec3 = [0, 0, 0];
  points.forEach((p, i) => (normal = add(normal, cross(p, points[(i + 1) % points.length]!))));
  const mean = scale(points.reduce(add, [0, 0, 0]), 1 / points.length);
  normal = normalized(normal);
  return points.map((p) => sub(p, scale(normal, dot(sub(p, mean), normal))));
}

/** The box around a shape, with a margin: what is leased while somebody works on it. */
export function boundsOf(shape: Shape, margin: number): Volume | null {
  const points = cornersOf(shape);
  if (points.length === 0) return null;
  const along = (axis: number): number[] => points.map((p) => p[axis]!);
  const least = [0, 1, 2].map((axis) => Math.min(...along(axis)) - margin) as Vec3;
  const most = [0, 1, 2].map((axis) => Math.max(...along(axis)) + margin) as Vec3;
  return { kind: "box", min: least, max: most };
}

function cornersOf(shape: Shape): Vec3[] {
  switch (shape.kind) {
    case "line":
    case "area":
      return shape.points;
    case "box":
      return [shape.min, shape.max];
    case "prism":
      return shape.points.flatMap(([x, y]): Vec3[] => [[x, y, shape.low], [x, y, shape.high]]);
    case "oriented_box":
    case "voxels":
      return []; // no tool makes them
  }
}
