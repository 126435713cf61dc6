/** Draws the faces that greedy.ts makes: shaded by the way they look, tinted by height, with the cells' edges near by. */
import { Color, DoubleSide, FrontSide, ShaderMaterial, Vector2 } from "three";

const kVertex = /* glsl */ `
attribute vec4 corner;
uniform mat4 mapFromWorld;
varying vec3 vCell;
varying float vHeight;
flat varying float vFace;
void main() {
  vec4 world = modelMatrix * vec4(corner.xyz, 1.0);
  vCell = corner.xyz;
  vFace = corner.w;
  vHeight = (mapFromWorld * world).z;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

const kFragment = /* glsl */ `
uniform vec3 tint;
uniform float tintShare;
uniform float opacity;
uniform vec2 clip;
uniform vec2 heights;
varying vec3 vCell;
varying float vHeight;
flat varying float vFace;

vec3 ramp(float t) {
  vec3 low = vec3(0.035, 0.085, 0.15);
  vec3 mid = vec3(0.15, 0.29, 0.31);
  vec3 high = vec3(0.72, 0.60, 0.42);
  return t < 0.5 ? mix(low, mid, t * 2.0) : mix(mid, high, t * 2.0 - 1.0);
}

float edge(vec2 p) {
  vec2 width = fwidth(p);
  vec2 away = abs(fract(p - 0.5) - 0.5) / max(width, vec2(1e-5));
  float line = 1.0 - min(min(away.x, away.y), 1.0);
  return line * (1.0 - smoothstep(0.08, 0.35, max(width.x, width.y)));
}

void main() {
  if (vHeight < clip.x || vHeight > clip.y) discard;
  float t = clamp((vHeight - heights.x) / max(heights.y - heights.x, 0.1), 0.0, 1.0);
  vec3 colour = mix(ramp(t), tint, tintShare);
  float light = vFace > 4.5 ? 1.0 : vFace > 3.5 ? 0.5 : vFace > 2.5 ? 0.8 : vFace > 1.5 ? 0.68 : vFace > 0.5 ? 0.88 : 0.74;
  vec2 plane = vFace < 1.5 ? vCell.yz : vFace < 3.5 ? vCell.xz : vCell.xy;
  light *= 1.0 - 0.22 * edge(plane);
  gl_FragColor = vec4(colour * light, opacity);
  #include <colorspace_fragment>
}`;

export interface VoxelStyle {
  /** Null: coloured by height alone. */
  tint: number | null;
  opacity: number;
  /** Lies over another layer's faces in the same place. */
  over: boolean;
}

export class VoxelMaterial extends ShaderMaterial {
  constructor(style: VoxelStyle) {
    super({
      vertexShader: kVertex,
      fragmentShader: kFragment,
      uniforms: {
        mapFromWorld: { value: null },
        tint: { value: new Color(style.tint ?? 0xffffff) },
        tintShare: { value: style.tint === null ? 0 : 0.85 },
        opacity: { value: style.opacity },
        clip: { value: new Vector2(-1e9, 1e9) },
        heights: { value: new Vector2(0, 3) },
      },
      transparent: style.opacity < 1,
      side: style.opacity < 1 ? FrontSide : DoubleSide,
      polygonOffset: style.over,
      polygonOffsetFactor: -2,
      polygonOffsetUnits: -2,
    });
  }
}
