// Keys, where no field of the page wants them.

const actions = (view) => ({
  "?": () => view.help.toggle(),
  l: () => view.set_surface({ wireframe: !view.surface.wireframe }),
  t: () => view.set_surface({ flat: !view.surface.flat }),
  b: () => view.set_boxes(!view.boxes.visible),
  c: () => view.set_caps(!view.clipping.caps),
  v: () => view.set_flying(!view.movement.flying),
  f: () => view.movement.frame(),
  r: () => view.movement.reset(),
  h: () => view.toggle_panel(),
  p: () => view.save_picture(),
  x: () => view.set_cut(0, { on: !view.clipping.axes[0].on }),
  y: () => view.set_cut(1, { on: !view.clipping.axes[1].on }),
  z: () => view.set_cut(2, { on: !view.clipping.axes[2].on }),
  Escape: () => view.pick.clear(),
});

const takes_text = (element) =>
  element.matches("input:not([type=checkbox]):not([type=range]):not([type=color]), select, textarea");

export function listen_to_keys(view) {
  const known = actions(view);
  window.addEventListener("keydown", (event) => {
    if (takes_text(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (view.help.dialog.open && event.key !== "?") return;
    if (view.movement.key_down(event)) return event.preventDefault();
    const mode = view.modes[Number(event.key) - 1];
    if (mode) view.set_mode(mode.name);
    else known[event.key.length === 1 ? event.key.toLowerCase() : event.key]?.();
  });
}
