/** The 2D grid between two heights, as a sheet at the lower one: occupied cells dark, free ones light, unknown ones not at all. */
import { DataTexture, DoubleSide, Group, Mesh, MeshBasicMaterial, NearestFilter, PlaneGeometry, SRGBColorSpace } from "three";
import type { CellsFrame } from "../protocol/frames";
import { discard } from "./shapes";

const kFree = [187, 247, 208, 150] as const;
const kOccupied = [30, 41, 59, 230] as const;

export class GridSheet {
  /** In the map's frame. */
  readonly group = new Group();

  constructor(
    private readonly resolution: number,
    /** Cells that the graphics card takes along one side. */
    private readonly most: number,
    private readonly drawn: () => void,
  ) {}

  /** Answers what the person is to be told, null if it is drawn. @param z metres */
  show({ low, size, cells }: CellsFrame, z: number): string | null {
    this.hide();
    const side = Math.max(size[0], size[1]);
    if (side > this.most) return `The grid is ${side} cells wide; this device draws at most ${this.most}.`;
    const pixels = new Uint8Array(4 * cells.length);
    cells.forEach((cell, i) => pixels.set(cell === 2 ? kOccupied : cell === 1 ? kFree : [0, 0, 0, 0], 4 * i));
    const texture = new DataTexture(pixels, size[0], size[1]);
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.colorSpace = SRGBColorSpace;
    texture.needsUpdate = true;
    const r = this.resolution;
    const material = new MeshBasicMaterial({ map: texture, transparent: true, side: DoubleSide, depthWrite: false });
    const sheet = new Mesh(new PlaneGeometry(size[0] * r, size[1] * r), material);
    sheet.position.set((low[0] + size[0] / 2) * r, (low[1] + size[1] / 2) * r, z);
    this.group.add(sheet);
    this.drawn();
    return null;
  }

  hide(): void {
    for (const sheet of [...this.group.children]) discard(sheet);
    this.drawn();
  }
}
