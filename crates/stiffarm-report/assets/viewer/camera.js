// Where one looks from, and how mouse, fingers and keys change it.

const VIEWS = {
  perspective: { turn: 0.559, tilt: 0.419, field: 30, words: 'Perspective' },
  side: { turn: 0, tilt: 0, field: 3, words: 'Side' },
  above: { turn: 0, tilt: Math.PI / 2, field: 3, words: 'Above' },
  front: { turn: Math.PI / 2, tilt: 0, field: 3, words: 'Front' },
};

/** Room for names at the edges of the picture, to the sides and above and below [px]. */
const ROOM = [34, 30];

/** A camera that turns around a place. `turn` and `tilt` [rad] as in the printed pictures: from the side at 0, 0. */
class Orbit {
  /** `points` are what must be seen; `turn` [rad] is that of the perspective, where the usual one has something before the arm. */
  constructor(points, turn = VIEWS.perspective.turn) {
    this.perspectiveTurn = turn;
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.1, 100);
    this.points = points;
    this.centre = points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(points.length || 1);
    this.radius = points.reduce((most, p) => Math.max(most, p.distanceTo(this.centre)), 1e-3);
    this.aspect = 1;
    this.room = [1, 1];
    this.look('perspective');
  }

  look(view) {
    Object.assign(this, VIEWS[view]);
    if (view === 'perspective') this.turn = this.perspectiveTurn;
    this.view = view;
    this.isFitted = true;
    this.fit();
  }

  axes() {
    const [s, c, up, out] = [Math.sin(this.turn), Math.cos(this.turn), Math.sin(this.tilt), Math.cos(this.tilt)];
    return {
      right: new Vector3(c, s, 0),
      up: new Vector3(-s * up, c * up, out),
      toward: new Vector3(s * out, -c * out, up),
    };
  }

  /** As near as everything is still seen with room for its names, and in the middle. */
  fit() {
    const { right, up, toward } = this.axes();
    const tangent = Math.tan((this.field * Math.PI) / 360);
    const [wide, high] = [tangent * this.aspect * this.room[0], tangent * this.room[1]];
    this.target = this.centre.clone();
    const from = new Vector3();
    for (let round = 0; round < 4; round += 1) {
      // Lines of sight along each edge of the picture, moved until they touch: what is seen of each point
      // grows with its distance, so the outermost is known without knowing how far one stands.
      const ends = { left: -Infinity, right: -Infinity, low: -Infinity, top: -Infinity };
      for (const point of this.points) {
        const off = from.subVectors(point, this.target);
        const [x, y, z] = [off.dot(right), off.dot(up), off.dot(toward)];
        ends.left = Math.max(ends.left, z - x / wide);
        ends.right = Math.max(ends.right, z + x / wide);
        ends.low = Math.max(ends.low, z - y / high);
        ends.top = Math.max(ends.top, z + y / high);
      }
      this.target.addScaledVector(right, ((ends.right - ends.left) * wide) / 2);
      this.target.addScaledVector(up, ((ends.top - ends.low) * high) / 2);
      this.distance = 1.02 * Math.max((ends.left + ends.right) / 2, (ends.low + ends.top) / 2, 1e-3);
    }
    this.place();
  }

  /** `width` and `height` of the picture [px]. */
  resize(width, height) {
    this.aspect = width / height;
    this.room = [width, height].map((size, k) => Math.max(1 - (2 * ROOM[k]) / size, 0.5));
    if (this.isFitted) this.fit();
    else this.place();
  }

  place() {
    const { up, toward } = this.axes();
    const camera = this.camera;
    camera.fov = this.field;
    camera.aspect = this.aspect;
    camera.near = Math.max(this.distance - 6 * this.radius, 0.02 * this.distance);
    camera.far = this.distance + 12 * this.radius;
    camera.position.copy(this.target).addScaledVector(toward, this.distance);
    camera.up.copy(up);
    camera.lookAt(this.target);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  rotate(dx, dy) {
    this.turn -= dx;
    this.tilt = Math.min(Math.max(this.tilt + dy, -Math.PI / 2), Math.PI / 2);
    this.moved();
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.05 * this.radius), 400 * this.radius);
    this.moved();
  }

  /** Shifts by shares of the picture's height. */
  pan(dx, dy) {
    const { right, up } = this.axes();
    const height = 2 * this.distance * Math.tan((this.field * Math.PI) / 360);
    this.target.addScaledVector(right, -dx * height).addScaledVector(up, dy * height);
    this.moved();
  }

  moved() {
    this.isFitted = false;
    this.view = '';
    this.place();
  }
}

const SENSITIVITY = 3.6;

/** Lets mouse and fingers on `stage` move the camera; `changed` is called after each move. */
function listen(stage, orbit, changed) {
  const down = new Map();
  let travelled = 0;
  const isActive = () => stage.classList.contains('scene-active');
  const activate = (on) => stage.classList.toggle('scene-active', on);
  document.addEventListener('pointerdown', (event) => {
    if (!stage.contains(event.target)) activate(false);
  });
  stage.addEventListener('pointerdown', (event) => {
    down.set(event.pointerId, [event.clientX, event.clientY]);
    travelled = 0;
    if (event.pointerType === 'mouse') {
      activate(true);
      stage.setPointerCapture(event.pointerId);
    }
  });
  stage.addEventListener('pointermove', (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    travelled += Math.abs(dx) + Math.abs(dy);
    const height = stage.clientHeight || 1;
    if (down.size === 2) {
      const other = [...down].find(([id]) => id !== event.pointerId)[1];
      const gap = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
      orbit.zoom(gap(before) / gap([event.clientX, event.clientY]));
      orbit.rotate((SENSITIVITY * dx) / height / 2, (SENSITIVITY * dy) / height / 2);
      changed();
    } else if (event.pointerType === 'mouse' && (event.shiftKey || event.buttons & 6)) {
      orbit.pan(dx / height, dy / height);
      changed();
    } else if (event.pointerType === 'mouse' || isActive()) {
      orbit.rotate((SENSITIVITY * dx) / height, (SENSITIVITY * dy) / height);
      changed();
    }
    down.set(event.pointerId, [event.clientX, event.clientY]);
  });
  const up = (event) => {
    const tapped = event.type === 'pointerup' && down.has(event.pointerId) && travelled < 8;
    if (tapped && event.pointerType !== 'mouse') activate(true);
    down.delete(event.pointerId);
  };
  stage.addEventListener('pointerup', up);
  stage.addEventListener('pointercancel', up);
  stage.addEventListener('contextmenu', (event) => event.preventDefault());
  // A page must still scroll over a picture that nobody has touched.
  stage.addEventListener('wheel', (event) => {
    if (!isActive() && document.activeElement !== stage && !event.ctrlKey) return;
    event.preventDefault();
    orbit.zoom(Math.exp(Math.min(Math.max(event.deltaY, -200), 200) * 0.0015));
    changed();
  }, { passive: false });
}

/** What a key does to the camera; false where it does nothing. */
function moveByKey(orbit, key) {
  const step = Math.PI / 24;
  const moves = {
    ArrowLeft: () => orbit.rotate(-step, 0),
    ArrowRight: () => orbit.rotate(step, 0),
    ArrowUp: () => orbit.rotate(0, step),
    ArrowDown: () => orbit.rotate(0, -step),
    '+': () => orbit.zoom(0.85),
    '=': () => orbit.zoom(0.85),
    '-': () => orbit.zoom(1 / 0.85),
    Home: () => orbit.look('perspective'),
  };
  if (!moves[key]) return false;
  moves[key]();
  return true;
}
