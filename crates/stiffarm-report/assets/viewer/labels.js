// Names over the picture, moved aside where they would lie on each other.

/** Offsets that are tried in turn, in label widths and heights from the place. */
const ASIDE = [[0, -0.75], [0.55, -0.5], [-0.55, -0.5], [0.6, 0], [-0.6, 0], [0, 0.75], [0.55, 0.6], [-0.55, 0.6], [0, -1.7], [0, 1.7]];

const pen = document.createElement('canvas').getContext('2d');

/** Width of text in pixels, without asking the page, which would have to lay itself out anew at every step. */
function widthOf(text, size, family) {
  pen.font = `600 ${size}px ${family}`;
  return pen.measureText(text).width;
}

class Labels {
  constructor(parent) {
    this.layer = document.createElement('div');
    this.layer.className = 'scene-labels';
    this.layer.setAttribute('aria-hidden', 'true');
    parent.append(this.layer);
    this.pool = [];
    this.shown = [];
  }

  /** `wanted`: text, place and kind of each, the most important first. */
  set(wanted) {
    while (this.pool.length < wanted.length) {
      const element = document.createElement('span');
      this.layer.append(element);
      this.pool.push({ element, text: null, width: 0, height: 0 });
    }
    this.shown = wanted.map((label, i) => {
      const slot = this.pool[i];
      if (slot.text !== label.text || slot.kind !== label.kind) {
        slot.element.textContent = label.text;
        slot.element.className = `scene-label scene-label-${label.kind}`;
        Object.assign(slot, { text: label.text, kind: label.kind, width: 0 });
      }
      return { ...label, slot };
    });
    for (const slot of this.pool.slice(wanted.length)) slot.element.style.visibility = 'hidden';
    this.family ??= getComputedStyle(this.layer).fontFamily;
    for (const { slot } of this.shown) {
      if (slot.width) continue;
      slot.width = widthOf(slot.text, 12, this.family) + 7;
      slot.height = 16;
    }
  }

  /** Puts each where its place is in the picture; leaves out what has no room. `taken`: rectangles kept free. */
  place(camera, width, height, taken) {
    const used = [...taken];
    for (const { at, slot } of this.shown) {
      const p = at.clone().project(camera);
      const [x, y] = [((p.x + 1) * width) / 2, ((1 - p.y) * height) / 2];
      const fits = p.z < 1 && ASIDE.map(([dx, dy]) => {
        const left = x + dx * (slot.width + 6) - slot.width / 2;
        const top = y + dy * (slot.height + 4) - slot.height / 2;
        return [left, top, left + slot.width, top + slot.height];
      }).find((r) => r[0] >= 0 && r[1] >= 0 && r[2] <= width && r[3] <= height
        && !used.some((u) => r[0] < u[2] && u[0] < r[2] && r[1] < u[3] && u[1] < r[3]));
      slot.element.style.visibility = fits ? 'visible' : 'hidden';
      if (!fits) continue;
      used.push(fits);
      slot.element.style.transform = `translate(${Math.round(fits[0])}px, ${Math.round(fits[1])}px)`;
    }
  }
}
