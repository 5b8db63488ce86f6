// Solids as meshes, and where each link is.

const { Vector3, Matrix4, Quaternion, Color } = THREE;

// three.js marks the page with its version; the page's only name of ours is `stiffarm`.
delete window.__THREE__;

const vec = (a) => new Vector3(a[0], a[1], a[2]);

/** Position and quaternion x, y, z, w as a matrix. */
function matrixOf(pose) {
  const turn = new Quaternion(pose[3], pose[4], pose[5], pose[6]);
  return new Matrix4().compose(vec(pose), turn, new Vector3(1, 1, 1));
}

/**
 * Frames of the base, of each link and of the flange, the joints turned `times` as far as by `turns`:
 * E_1 … E_i · pose_i, with E_k the turn about axis k of the unloaded arm, the z axis of link k.
 */
function framesOf(data, posture, turns, times) {
  const frames = [new Matrix4()];
  const moved = new Matrix4();
  const axis = new Vector3();
  const origin = new Vector3();
  posture.links.forEach((pose, i) => {
    const link = matrixOf(pose);
    if (turns && times) {
      axis.setFromMatrixColumn(link, 2);
      origin.setFromMatrixPosition(link);
      const turn = new Matrix4().makeRotationAxis(axis, times * turns[i]);
      turn.setPosition(origin.clone().sub(origin.clone().applyMatrix4(turn)));
      moved.multiply(turn);
    }
    frames.push(moved.clone().multiply(link));
  });
  frames.push(frames[frames.length - 1].clone().multiply(matrixOf(data.flange)));
  return frames;
}

/** The turn that brings the y axis, which round shapes are made about, to a direction. */
const turnOfY = (direction) => new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), direction);

/** The geometry of a solid in its carrier's frame; null for a plane. */
function geometryOf(solid) {
  if (solid.kind === 'capsule') {
    const a = vec(solid.a);
    const along = vec(solid.b).sub(a);
    const length = along.length();
    const shape = new THREE.CapsuleGeometry(solid.radius, length, 8, 28);
    if (length > 1e-9) shape.applyQuaternion(turnOfY(along.clone().divideScalar(length)));
    const middle = a.addScaledVector(along, 0.5);
    return shape.translate(middle.x, middle.y, middle.z);
  }
  if (solid.kind === 'block') {
    const [x, y, z] = solid.half;
    return new THREE.BoxGeometry(2 * x, 2 * y, 2 * z).applyMatrix4(matrixOf(solid.pose));
  }
  if (solid.kind === 'cylinder') {
    const shape = new THREE.CylinderGeometry(solid.radius, solid.radius, 2 * solid.half_length, 36);
    return shape.rotateX(Math.PI / 2).applyMatrix4(matrixOf(solid.pose));
  }
  return null;
}

/** Middle of a solid in its carrier's frame; null for a plane. */
function middleOf(solid) {
  if (solid.kind === 'capsule') return vec(solid.a).add(vec(solid.b)).multiplyScalar(0.5);
  return solid.pose ? vec(solid.pose) : null;
}

/** A cone on a shaft from one place to another, made once and moved. */
class ArrowMesh {
  constructor(material) {
    this.group = new THREE.Group();
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 16), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 20), material);
    this.group.add(this.shaft, this.head);
  }

  /** From `from` to `to`, its shaft so thick. */
  set(from, to, radius) {
    const along = to.clone().sub(from);
    const length = along.length();
    this.group.visible = length > 1e-9;
    if (!this.group.visible) return;
    const head = Math.min(6 * radius, 0.6 * length);
    this.group.position.copy(from);
    this.group.quaternion.copy(turnOfY(along.divideScalar(length)));
    this.shaft.scale.set(radius, length - head, radius);
    this.shaft.position.set(0, (length - head) / 2, 0);
    this.head.scale.set(2.4 * radius, head, 2.4 * radius);
    this.head.position.set(0, length - head / 2, 0);
  }
}

/** Colours of a scale that stays readable for every kind of colour vision (viridis), by share from 0 to 1. */
const SCALE = ['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];

function scaleColour(share) {
  const at = Math.min(Math.max(share, 0), 1) * (SCALE.length - 1);
  const low = Math.min(Math.floor(at), SCALE.length - 2);
  return new Color(SCALE[low]).lerp(new Color(SCALE[low + 1]), at - low);
}

/** The largest of 1, 2, 5 times a power of ten that is not above a value. */
function niceBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = [5, 2, 1].find((d) => d * power <= value * (1 + 1e-9));
  return Number(((digit || 1) * power).toPrecision(3));
}
