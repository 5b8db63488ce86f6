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
  const hide = () => {
    tip?.remove();
    tip = null;
  };
  document.addEventListener("pointerover", (event) => {
    const place = event.target.closest?.("[data-tip]");
    hide();
    if (!place) return;
    tip = document.createElement("div");
    tip.className = "tip";
    tip.textContent = place.dataset.tip;
    document.body.append(tip);
    const box = place.getBoundingClientRect();
    const width = tip.offsetWidth;
    const left = Math.min(Math.max(box.left + box.width / 2 - width / 2, 4), innerWidth - width - 4);
    const above = Math.max(box.top, 0) - tip.offsetHeight - 6;
    tip.style.left = `${left}px`;
    tip.style.top = `${above > 4 ? above : box.bottom + 6}px`;
  });
  document.addEventListener("scroll", hide, { passive: true, capture: true });
  // Paper has nothing to click on.
  window.addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("details.more")) details.open = true;
  });
})();
