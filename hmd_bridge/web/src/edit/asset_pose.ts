/** Where assets lie. */
import type { Instance, Pose } from "../../generated/messages";
import { kIdentity, type Vec3 } from "../base/vec";

/** A point says where a thing goes, and nothing of its turn: it keeps the one that it has. */
export const keptTurnAt = ({ T_map_asset }: Pick<Instance, "T_map_asset">, position: Vec3): Pose =>
  ({ position, rotation: (T_map_asset ?? kIdentity).rotation });
