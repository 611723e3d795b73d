// The view as a link: what differs from the first view stands behind the # of the address.

const quiet_ms = 250;

// Labels that are hidden, or, where that is shorter, those that are not.
function labels_text(labels) {
  const hidden = [...labels.hidden];
  if (hidden.length === 0) return {};
  const shown = [...labels.rows.keys()].filter((label) => !labels.hidden.has(label));
  return shown.length < hidden.length ? { only: shown.join() } : { hide: hidden.join() };
}

function restore_labels(labels, values) {
  if (values.has("only")) {
    labels.show_all(false);
    for (const label of values.get("only").split(",")) labels.show(label, true);
  }
  for (const label of (values.get("hide") ?? "").split(",").filter(Boolean)) labels.show(label, false);
}

export class Link {
  constructor(view) {
    this.view = view;
    this.timer = null;
    this.ready = false;
    window.addEventListener("hashchange", () => {
      if (location.hash !== this.written) this.restore();
    });
  }

  changed() {
    if (!this.ready) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), quiet_ms);
  }

  text() {
    const { movement, surface, clipping, boxes, labels } = this.view;
    const values = {
      camera: movement.touched ? movement.state().join() : "",
      colour: surface.mode === this.view.first_mode ? "" : surface.mode,
      plain: surface.colour.getHexString() === this.view.first_colour ? "" : surface.colour.getHexString(),
      lines: surface.wireframe ? 1 : "", flat: surface.flat ? 1 : "", boxes: boxes.visible ? 1 : "",
      cut: clipping.state(), open: clipping.caps ? "" : 1, ...labels_text(labels),
    };
    const parts = Object.entries(values).filter(([, value]) => value !== "");
    return parts.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",")}`).join("&");
  }

  write() {
    const text = this.text();
    this.written = text === "" ? "" : "#" + text;
    history.replaceState(null, "", this.written || location.pathname);
  }

  restore() {
    const values = new URLSearchParams(location.hash.slice(1)), { view } = this;
    if (values.has("camera")) view.movement.restore(values.get("camera").split(",").map(Number));
    const plain = values.get("plain");
    if (/^[0-9a-f]{6}$/.test(plain ?? "")) view.surface.colour.set("#" + plain);
    view.surface.set({
      mode: view.modes.some(({ name }) => name === values.get("colour")) ? values.get("colour") : view.first_mode,
      wireframe: values.has("lines"), flat: values.has("flat"),
    });
    view.boxes.visible = values.has("boxes");
    view.clipping.caps = !values.has("open");
    for (const axis of view.clipping.axes) axis.on = false;
    view.clipping.restore(values.get("cut") ?? "");
    restore_labels(view.labels, values);
    view.surface.labels_changed();
    this.ready = true;
    view.shown();
  }
}
