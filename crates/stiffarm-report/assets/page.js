"use strict";
// The switch between light and dark, and charts that answer: series that can be put out, values under the pointer.
(() => {
  const root = document.documentElement;
  const theme = document.getElementById("theme");
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const show = () => {
    root.dataset.theme = isDark() ? "dark" : "light";
    theme.textContent = isDark() ? "Light" : "Dark";
    theme.setAttribute("aria-pressed", String(isDark()));
    document.dispatchEvent(new Event("themechange"));
  };
  theme.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    show();
  });
  system.addEventListener("change", () => {
    delete root.dataset.theme;
    show();
  });
  show();
  // An entry of a legend puts its series out, and back.
  const toggle = (entry) => {
    const on = entry.getAttribute("aria-pressed") !== "true";
    entry.setAttribute("aria-pressed", String(on));
    for (const one of entry.ownerSVGElement.querySelectorAll("[data-series]")) {
      if (one.dataset.series === entry.dataset.toggleSeries) one.classList.toggle("off", !on);
    }
  };
  document.addEventListener("click", (event) => {
    const entry = event.target.closest("[data-toggle-series]");
    if (entry) toggle(entry);
  });
  document.addEventListener("keydown", (event) => {
    const entry = event.target.closest?.("[data-toggle-series]");
    if (entry && (event.key === "Enter" || event.key === " ")) {
      event.preventDefault();
      toggle(entry);
    }
  });
  // The value under the pointer, or under the finger.
  let tip = null;
  let told = null;
  const hide = () => {
    tip?.remove();
    tip = told = null;
  };
  // Below and right of the place, on the other side where the window ends: never over the place itself. A finger
  // covers what is below it.
  const put = (event) => {
    const box = told.getBoundingClientRect();
    const isMark = box.width < 40 && box.height < 40;
    const [x, y] = [event.clientX, event.clientY];
    const place = isMark ? box : { left: x - 8, right: x + 8, top: y - 8, bottom: y + 8 };
    const [width, height] = [tip.offsetWidth, tip.offsetHeight];
    const isRight = place.right + width + 8 < document.documentElement.clientWidth;
    const isBelow = event.pointerType !== "touch" && place.bottom + height + 8 < innerHeight;
    const left = isRight ? place.right + 4 : place.left - width - 4;
    const top = isBelow || place.top < height + 8 ? place.bottom + 4 : place.top - height - 4;
    tip.style.left = `${Math.max(left, 4)}px`;
    tip.style.top = `${top}px`;
  };
  document.addEventListener("pointerover", (event) => {
    hide();
    told = event.target.closest?.("[data-tip]") ?? null;
    if (!told) return;
    tip = document.createElement("div");
    tip.className = "tip";
    tip.textContent = told.dataset.tip;
    document.body.append(tip);
    put(event);
  });
  document.addEventListener("pointermove", (event) => {
    if (tip) put(event);
  }, { passive: true });
  document.addEventListener("scroll", hide, { passive: true, capture: true });
  // Paper has nothing to click on.
  window.addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("details.more")) details.open = true;
  });
})();
