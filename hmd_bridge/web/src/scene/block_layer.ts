/** Draws one block store: keeps a mesh for each block, made in workers, and counts its triangles. */
import { BufferAttribute, BufferGeometry, Group, Mesh, Sphere, Vector3, type Matrix4 } from "three";
import type { BlockStore } from "../map/block_store";
import { BLOCK, cellScale, keyOf, type BlockId, type BlockKey } from "../map/lattice";
import type { MeshDone } from "../map/mesh_job";
import { packJob } from "../map/mesh_job";
import type { Mesher } from "../map/mesher";
import { VoxelMaterial, type VoxelStyle } from "./voxel_material";

let layers = 0;

export class BlockLayer {
  /** In the lattice's frame, metres. */
  readonly group = new Group();
  readonly material: VoxelMaterial;
  triangles = 0;
  private readonly meshes = new Map<BlockKey, Mesh>();
  private readonly name = `layer ${++layers}`;

  /** @param drawn called when what is drawn has changed */
  constructor(
    private readonly store: BlockStore,
    private readonly mesher: Mesher,
    private readonly resolution: number,
    style: VoxelStyle,
    mapFromWorld: Matrix4,
    private readonly drawn: () => void,
  ) {
    this.material = new VoxelMaterial(style);
    this.material.uniforms["mapFromWorld"]!.value = mapFromWorld;
  }

  /** Sends what has changed to be meshed. */
  update(): void {
    for (const id of this.store.takeDirty()) this.remesh(id);
  }

  dispose(): void {
    for (const mesh of this.meshes.values()) mesh.geometry.dispose();
    this.meshes.clear();
    this.material.dispose();
    this.group.removeFromParent();
  }

  private remesh({ level, index }: BlockId): void {
    const key = keyOf(level, index);
    const make = (): ReturnType<typeof packJob> | null => {
      const block = this.store.find(level, index);
      return block ? packJob(0, block, (neighbour) => this.store.find(level, neighbour)) : null;
    };
    this.mesher.mesh(`${this.name} ${key}`, make, (mesh) => this.replace(key, { level, index }, mesh));
  }

  private replace(key: BlockKey, id: BlockId, done: MeshDone | null): void {
    const old = this.meshes.get(key);
    if (old) {
      this.triangles -= old.geometry.index!.count / 3;
      old.geometry.dispose();
      old.removeFromParent();
      this.meshes.delete(key);
    }
    // It may have gone while it was being meshed.
    if (done && done.indices.length > 0 && this.store.find(id.level, id.index)) this.add(key, id, done);
    this.drawn();
  }

  private add(key: BlockKey, { level, index }: BlockId, { corners, indices }: MeshDone): void {
    const geometry = new BufferGeometry();
    geometry.setAttribute("corner", new BufferAttribute(corners, 4));
    geometry.setIndex(new BufferAttribute(corners.length / 4 < 65536 ? Uint16Array.from(indices) : indices, 1));
    geometry.boundingSphere = new Sphere(new Vector3(BLOCK / 2, BLOCK / 2, BLOCK / 2), (BLOCK / 2) * Math.sqrt(3));
    const mesh = new Mesh(geometry, this.material);
    const cell = this.resolution * cellScale(level);
    mesh.scale.setScalar(cell);
    mesh.position.set(...index).multiplyScalar(BLOCK * cell);
    this.triangles += indices.length / 3;
    this.meshes.set(key, mesh);
    this.group.add(mesh);
  }
}
