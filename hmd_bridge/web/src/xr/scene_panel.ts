/** A panel of buttons in the scene: headset browsers lay no page over an immersive session. */
import { CanvasTexture, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace, type Raycaster } from "three";
import { buttonAt, kPanelWidth, panelHeight, placed, type PanelPage, type PlacedButton } from "./panel_layout";

const kMetresWide = 0.6;

export class ScenePanel {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly canvas = document.createElement("canvas");
  private page: PanelPage = { title: "", words: "", rows: [] };
  private buttons: PlacedButton[] = [];
  private hovered: string | null = null;

  constructor() {
    this.mesh = new Mesh(new PlaneGeometry(1, 1), new MeshBasicMaterial({ transparent: true, depthTest: false }));
    this.mesh.renderOrder = 20;
  }

  get pageShown(): PanelPage {
    return this.page;
  }

  show(page: PanelPage): void {
    const taller = panelHeight(page) !== this.canvas.height || this.mesh.material.map === null;
    this.page = page;
    this.buttons = placed(page);
    if (taller) this.resize();
    this.draw();
  }

  /** What a ray points at: the panel, and perhaps one of its buttons. */
  aim(caster: Raycaster): { distance: number; button: string | null } | null {
    const hit = caster.intersectObject(this.mesh, false)[0];
    if (!hit?.uv) return null;
    const at = buttonAt(this.buttons, hit.uv.x * kPanelWidth, (1 - hit.uv.y) * this.canvas.height);
    return { distance: hit.distance, button: at?.id ?? null };
  }

  setHovered(id: string | null): void {
    if (id === this.hovered) return;
    this.hovered = id;
    this.draw();
  }

  /** Middle of a button in the panel's own frame, for those who press it otherwise than by a ray. */
  centreOf(id: string): [number, number] | null {
    const at = this.buttons.find((b) => b.id === id);
    if (!at) return null;
    return [((at.x + at.width / 2) / kPanelWidth - 0.5) * this.mesh.scale.x, (0.5 - (at.y + at.height / 2) / this.canvas.height) * this.mesh.scale.y];
  }

  private resize(): void {
    this.canvas.width = kPanelWidth;
    this.canvas.height = panelHeight(this.page);
    this.mesh.material.map?.dispose();
    const texture = new CanvasTexture(this.canvas);
    texture.colorSpace = SRGBColorSpace;
    texture.minFilter = LinearFilter;
    texture.generateMipmaps = false;
    this.mesh.material.map = texture;
    this.mesh.material.needsUpdate = true;
    this.mesh.scale.set(kMetresWide, (kMetresWide * this.canvas.height) / this.canvas.width, 1);
  }

  private draw(): void {
    const pen = this.canvas.getContext("2d")!;
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.fillStyle = "rgba(16, 20, 27, 0.93)";
    pen.beginPath();
    pen.roundRect(0, 0, this.canvas.width, this.canvas.height, 28);
    pen.fill();
    pen.textBaseline = "middle";
    pen.textAlign = "left";
    pen.fillStyle = "#ffffff";
    pen.font = "700 36px system-ui, sans-serif";
    pen.fillText(this.page.title, 24, 38, kPanelWidth - 48);
    pen.fillStyle = "#c3ccda";
    pen.font = "25px system-ui, sans-serif";
    wrapped(pen, this.page.words, kPanelWidth - 48).slice(0, 2).forEach((line, i) => pen.fillText(line, 24, 78 + i * 31));
    for (const button of this.buttons) this.drawButton(pen, button);
    this.mesh.material.map!.needsUpdate = true;
  }

  private drawButton(pen: CanvasRenderingContext2D, { id, title, x, y, width, height, pressed, disabled, main }: PlacedButton): void {
    const hovered = id === this.hovered;
    pen.globalAlpha = disabled ? 0.4 : 1;
    pen.fillStyle = pressed || main ? (hovered ? "#cf3a62" : "#9e1b40") : hovered ? "#3d4c66" : "#242e3f";
    pen.beginPath();
    pen.roundRect(x, y, width, height, 16);
    pen.fill();
    if (hovered) {
      pen.lineWidth = 4;
      pen.strokeStyle = "#ffffff";
      pen.stroke();
    }
    pen.fillStyle = "#ffffff";
    pen.font = "600 29px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillText(title, x + width / 2, y + height / 2 + 1, width - 12);
    pen.globalAlpha = 1;
  }
}

function wrapped(pen: CanvasRenderingContext2D, text: string, width: number): string[] {
  const lines: string[] = [];
  let line = "";
  for (const word of text.split(" ")) {
    const longer = line ? `${line} ${word}` : word;
    if (line && pen.measureText(longer).width > width) {
      lines.push(line);
      line = word;
    } else {
      line = longer;
    }
  }
  return [...lines, line];
}
