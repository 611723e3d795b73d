import { View } from "./view.js";

async function scene_of_server() {
  const answer = await fetch("api/scene");
  const scene = await answer.json();
  if (!answer.ok) throw new Error(scene.error ?? answer.statusText);
  return scene;
}

// For tests and the console: window.voxweld.state says how far it has come.
window.voxweld = { state: { status: "starting", errors: [] } };
try {
  const view = new View(await scene_of_server());
  window.voxweld = { view, state: view.state };
} catch (error) {
  window.voxweld.state = { status: "error", errors: [String(error?.message ?? error)] };
  const note = document.createElement("p");
  note.className = "bad";
  note.textContent = String(error?.message ?? error);
  document.getElementById("notes").append(note);
}
