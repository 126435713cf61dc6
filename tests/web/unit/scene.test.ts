import assert from "node:assert/strict";
import { test } from "node:test";
import { BoxGeometry, DataTexture, Group, InstancedMesh, Mesh, MeshBasicMaterial, Sprite, SpriteMaterial, type EventDispatcher, type Object3D } from "three";
import type { CellsFrame } from "../../../hmd_bridge/web/src/protocol/frames";
import { GridSheet } from "../../../hmd_bridge/web/src/scene/grid_sheet";
import { discard } from "../../../hmd_bridge/web/src/scene/shapes";

const grid = (wide: number, deep: number): CellsFrame => ({ kind: "cells", request: 1, low: [0, 0], size: [wide, deep], cells: new Uint8Array(wide * deep).fill(1) });
const texture = (): DataTexture => new DataTexture(new Uint8Array(4), 1, 1);

/** Notes when something is freed on the graphics card: three.js does so at this event. */
function freed(...of: object[]): () => number {
  let count = 0;
  for (const each of of) (each as EventDispatcher<{ dispose: object }>).addEventListener("dispose", () => ++count);
  return () => count;
}

test("what is discarded frees its textures and the buffers of its instances, too", () => {
  const [sheet, name] = [texture(), texture()];
  const cubes = new InstancedMesh(new BoxGeometry(), new MeshBasicMaterial(), 3);
  const group = new Group();
  group.add(new Mesh(new BoxGeometry(), new MeshBasicMaterial({ map: sheet })), new Sprite(new SpriteMaterial({ map: name })), cubes);
  const count = freed(sheet, name, cubes, cubes.geometry, cubes.material);
  discard(group);
  assert.equal(count(), 5);
});

test("a grid takes the place of the one before, which is freed; one that is too wide is refused in words", () => {
  const sheet = new GridSheet(0.05, 8, () => {});
  const shown = (): Object3D[] => sheet.group.children;
  assert.equal(sheet.show(grid(8, 2), 0), null);
  const before = freed((shown()[0] as Mesh<BoxGeometry, MeshBasicMaterial>).material.map!);
  assert.equal(sheet.show(grid(3, 8), 0), null);
  assert.equal(before(), 1);
  assert.equal(shown().length, 1);
  assert.match(sheet.show(grid(2, 9), 0)!, /9 cells wide.*at most 8/);
  assert.equal(shown().length, 0);
});
