// Lines of any width in pixels.

/** Many separate pieces of line that look alike. */
class Lines {
  constructor(width, options = {}) {
    this.material = new THREE.LineMaterial({ linewidth: width, ...options });
    this.object = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), this.material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  /** `pieces`: six numbers each. `colours`, where each end has its own: six numbers each too. */
  set(pieces, colours) {
    this.object.visible = pieces.length > 0;
    if (!pieces.length) return;
    this.object.geometry.dispose();
    const shape = new THREE.LineSegmentsGeometry();
    shape.setPositions(pieces);
    if (colours) shape.setColors(colours);
    this.object.geometry = shape;
    if (this.material.dashed) this.object.computeLineDistances();
  }
}

/** Many separate pieces of line one pixel wide: without a graphics card, fat ones would take four times as long. */
class ThinLines {
  constructor(options = {}) {
    this.material = new THREE.LineBasicMaterial(options);
    this.object = new THREE.LineSegments(new THREE.BufferGeometry(), this.material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  /** `pieces`: six numbers each. */
  set(pieces) {
    this.object.visible = pieces.length > 0;
    if (!pieces.length) return;
    this.object.geometry.dispose();
    this.object.geometry = new THREE.BufferGeometry();
    this.object.geometry.setAttribute('position', new THREE.Float32BufferAttribute(pieces, 3));
  }
}

/** Puts the pieces of a line through points behind `pieces`. */
function pushLine(pieces, points) {
  for (let i = 1; i < points.length; i += 1) pieces.push(...points[i - 1].toArray(), ...points[i].toArray());
}

/** From the base over the joints to the flange and to what is loaded. */
function armLine(frames, at) {
  const points = frames.map((frame) => new Vector3().setFromMatrixPosition(frame));
  points.push(at);
  return points.filter((p, i) => i === 0 || p.distanceTo(points[i - 1]) > 1e-6);
}

/** The twelve edges of a box. */
function boxLines([low, high]) {
  const pieces = [];
  const corner = (i) => new Vector3(...[0, 1, 2].map((k) => ((i >> k) & 1 ? high[k] : low[k])));
  for (let i = 0; i < 8; i += 1) {
    for (const bit of [1, 2, 4]) if (!(i & bit)) pushLine(pieces, [corner(i), corner(i | bit)]);
  }
  return pieces;
}

/** A circle about an axis. */
function circleLines(centre, axis, radius) {
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), axis);
  const points = Array.from({ length: 65 }, (_, i) => {
    const angle = (2 * Math.PI * i) / 64;
    return new Vector3(Math.cos(angle), Math.sin(angle), 0).multiplyScalar(radius).applyQuaternion(turn).add(centre);
  });
  const pieces = [];
  pushLine(pieces, points);
  return pieces;
}

/** A level grid over an extent with lines at multiples of `step`. */
function gridLines(low, high, z, step) {
  const pieces = [];
  const [x0, y0] = [low.x, low.y].map((v) => Math.floor(v / step) * step);
  const [x1, y1] = [high.x, high.y].map((v) => Math.ceil(v / step) * step);
  for (let x = x0; x < x1 + step / 2; x += step) pieces.push(x, y0, z, x, y1, z);
  for (let y = y0; y < y1 + step / 2; y += step) pieces.push(x0, y, z, x1, y, z);
  return { pieces, low: [x0, y0], high: [x1, y1] };
}
