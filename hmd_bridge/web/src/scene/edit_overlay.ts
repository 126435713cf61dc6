/** Draws what this person is doing: their selection in burgundy, their unsent scene, the small map that they align. */
import { BoxGeometry, Group, InstancedMesh, Matrix4, Mesh, MeshBasicMaterial, SphereGeometry } from "three";
import type { AlignSession, Aligning } from "../edit/align_session";
import type { Editor } from "../edit/editor";
import type { SceneDraft } from "../edit/scene_draft";
import { shapeOf, withPoint, type Selection } from "../edit/selection";
import type { Vec3 } from "../base/vec";
import type { Pose } from "../../generated/messages";
import { composed, kIdentity } from "../base/vec";
import { kMinimap, kSelection } from "./colours";
import { discard, edgesObject, shapeObject } from "./shapes";
import { place } from "./three_pose";

const kMinimapCell = 0.42;

export class EditOverlay {
  readonly group = new Group();
  private readonly selected = new Group();
  private readonly drafted = new Group();
  private readonly aligned = new Group();
  private readonly cursor = new Mesh(new SphereGeometry(0.05, 14, 10), new MeshBasicMaterial({ color: kSelection, depthTest: false, transparent: true }));
  private hover: Vec3 | null = null;
  private shown: Float32Array | null = null;

  /** @param targetPose T_map_target of the agent that is aligned to; null while it is in no map. */
  constructor(
    private readonly editor: Editor,
    draft: SceneDraft,
    align: AlignSession,
    private readonly targetPose: (target: string | undefined) => Pose | null,
    private readonly resolution: number,
    private readonly drawn: () => void,
  ) {
    this.group.add(this.selected, this.drafted, this.aligned, this.cursor);
    this.cursor.visible = false;
    this.cursor.renderOrder = 11;
    editor.selection.watch(() => this.drawSelection());
    draft.open.watch((open) => {
      this.clear(this.drafted);
      for (const { shape } of open?.edits ?? []) this.drafted.add(shapeObject(shape, this.resolution, kSelection, 0.12));
      for (const { volume } of open?.zones ?? []) this.drafted.add(shapeObject(volume, this.resolution, kSelection, 0.12));
      drawn();
    });
    align.current.watch((aligning) => this.drawAligning(aligning));
  }

  /** In a headset the small map stands on a table instead. */
  setMinimapShown(shown: boolean): void {
    this.aligned.visible = shown;
  }

  /** Where the next point would be; null: nowhere. */
  setHover(p: Vec3 | null): void {
    this.hover = p;
    const wanted = p !== null && (this.editor.question.value !== null || (this.editor.selection.value !== null && !this.editor.selection.value.closed));
    this.cursor.visible = wanted;
    if (p) this.cursor.position.set(...p);
    if (this.editor.selection.value) this.drawSelection();
    this.drawn();
  }

  private drawSelection(): void {
    this.clear(this.selected);
    const selection = this.editor.selection.value;
    if (selection) this.drawPoints(selection);
    else this.cursor.visible = false;
    this.drawn();
  }

  private drawPoints(selection: Selection): void {
    const preview = this.hover && !selection.closed ? withPoint(selection, this.hover) : selection;
    const shape = shapeOf(preview);
    if (shape) this.selected.add(shapeObject(shape, this.resolution, kSelection, 0.3));
    else if (preview.points.length > 1) this.selected.add(edgesObject(preview.points.slice(1).map((p, i) => [preview.points[i]!, p]), kSelection, true));
    for (const p of selection.points) {
      const knob = new Mesh(new SphereGeometry(0.04, 12, 8), new MeshBasicMaterial({ color: kSelection, depthTest: false, transparent: true }));
      knob.position.set(...p);
      knob.renderOrder = 11;
      this.selected.add(knob);
    }
  }

  private drawAligning(aligning: Aligning | null): void {
    if (!aligning || aligning.points !== this.shown) this.clear(this.aligned);
    this.shown = aligning?.points ?? null;
    if (aligning) {
      if (this.aligned.children.length === 0) this.aligned.add(minimapObject(aligning.points));
      place(this.aligned, composed(this.targetPose(aligning.target) ?? kIdentity, aligning.guess));
    }
    this.drawn();
  }

  private clear(group: Group): void {
    for (const child of [...group.children]) discard(child);
  }
}

export function minimapObject(points: Float32Array): InstancedMesh {
  const material = new MeshBasicMaterial({ color: kMinimap, transparent: true, opacity: 0.55, depthWrite: false });
  const cubes = new InstancedMesh(new BoxGeometry(kMinimapCell, kMinimapCell, kMinimapCell), material, points.length / 3);
  const at = new Matrix4();
  for (let i = 0; i < points.length / 3; ++i) cubes.setMatrixAt(i, at.makeTranslation(points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!));
  cubes.frustumCulled = false;
  return cubes;
}
