/** Objects of the scene for lines, volumes, bands and names. Whoever makes one disposes of it with `discard`. */
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, DoubleSide, ExtrudeGeometry, Group, InstancedMesh, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, Object3D, Shape as Outline, Sprite, SpriteMaterial, Vector2, type Material, type Texture,
} from "three";
import type { Path, Shape, Volume } from "../../generated/messages";
import { outline, type Edge } from "../edit/outline";
import { place } from "./three_pose";
import { ribbon } from "./ribbon";

export function edgesObject(edges: Edge[], colour: number, onTop = false): LineSegments {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(edges.flat(2)), 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ color: colour, depthTest: !onTop, transparent: onTop }));
  if (onTop) lines.renderOrder = 10;
  return lines;
}

/** The edges of a shape, and its sides half transparent where it is a volume. */
export function shapeObject(shape: Shape | Volume, resolution: number, colour: number, opacity: number): Group {
  const group = new Group();
  group.add(edgesObject(outline(shape, resolution), colour, true));
  const body = bodyOf(shape);
  if (body) {
    body.material = new MeshBasicMaterial({ color: colour, transparent: true, opacity, depthWrite: false, side: DoubleSide });
    group.add(body);
  }
  return group;
}

function bodyOf(shape: Shape | Volume): Mesh | null {
  switch (shape.kind) {
    case "box": {
      const size = shape.max.map((high, i) => high - shape.min[i]!) as [number, number, number];
      const mesh = new Mesh(new BoxGeometry(...size));
      mesh.position.set(...shape.min).addScaledVector(mesh.position.clone().set(...size), 0.5);
      return mesh;
    }
    case "oriented_box": {
      const mesh = new Mesh(new BoxGeometry(...shape.size));
      place(mesh, shape.T_frame_box);
      return mesh;
    }
    case "prism": {
      const plan = new Outline(shape.points.map(([x, y]) => new Vector2(x, y)));
      const mesh = new Mesh(new ExtrudeGeometry(plan, { depth: shape.high - shape.low, bevelEnabled: false }));
      mesh.position.z = shape.low;
      return mesh;
    }
    case "area": {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(Float32Array.from(shape.points.flat()), 3));
      geometry.setIndex(Array.from({ length: Math.max(0, shape.points.length - 2) }, (_, i) => [0, i + 1, i + 2]).flat());
      return new Mesh(geometry);
    }
    case "line":
    case "voxels":
      return null;
  }
}

const kRibbonWidth = 0.16;
const kRibbonLift = 0.06;

export function pathObject(path: Path): Mesh {
  const { positions, colours, indices } = ribbon(path.points, kRibbonWidth, kRibbonLift);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("color", new BufferAttribute(colours.map((c) => c ** 2.2), 3)); // three.js counts in linear light
  geometry.setIndex(indices);
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true, side: DoubleSide, depthTest: false, transparent: true, opacity: 0.95 }));
  mesh.renderOrder = 9;
  mesh.frustumCulled = false;
  return mesh;
}

const kTextPixels = 44;

/** A name that always faces who looks. @param height of the letters, metres */
export function nameSprite(text: string, colour: number, height: number): Sprite {
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d")!;
  const font = `600 ${kTextPixels}px system-ui, sans-serif`;
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 36;
  canvas.height = kTextPixels + 28;
  pen.font = font;
  pen.fillStyle = "rgba(16, 20, 27, 0.78)";
  pen.beginPath();
  pen.roundRect(0, 0, canvas.width, canvas.height, 18);
  pen.fill();
  pen.fillStyle = `#${colour.toString(16).padStart(6, "0")}`;
  pen.textBaseline = "middle";
  pen.fillText(text, 18, canvas.height / 2 + 2);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false, transparent: true }));
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  sprite.renderOrder = 12;
  return sprite;
}

/** Takes an object out of the scene and frees what it holds on the graphics card. */
export function discard(object: Object3D): void {
  object.removeFromParent();
  object.traverse((part) => {
    if (part instanceof Mesh || part instanceof LineSegments || part instanceof Sprite) {
      if (!(part instanceof Sprite)) (part.geometry as BufferGeometry).dispose();
      if (part instanceof InstancedMesh) part.dispose();
      for (const material of [part.material].flat() as (Material & { map?: Texture | null })[]) {
        material.map?.dispose();
        material.dispose();
      }
    }
  });
}
