// Plays the executions of a page, any of them from its start. `played` are all, in their order.
const animator = viewer.animator, time = document.getElementById("time");
const entries = [...document.querySelectorAll("#executions button")];
const now = () => played.findLastIndex((one) => one.start <= Number(time.value) + 1e-6);
function seek(t) {
  animator.seek(t);
  animator.display_progress(t);
}
document.getElementById("play").onclick = () => {
  if (animator.playing) animator.pause(); else animator.play();
};
time.oninput = () => {
  animator.pause();
  seek(Number(time.value));
};
entries.forEach((entry, i) => {
  entry.onclick = () => {
    seek(played[i].start);
    animator.play();
  };
});
const follow = () => {
  time.value = animator.time;
  const i = now(), one = played[i], t = Math.min(animator.time, one.end) - one.start;
  document.getElementById("play").textContent = animator.playing ? "pause" : "play";
  document.getElementById("clock").textContent =
    `${i + 1} of ${played.length}, ${t.toFixed(1)} of ${(one.end - one.start).toFixed(1)} s`;
  entries.forEach((entry, k) => entry.setAttribute("aria-current", k === i));
  requestAnimationFrame(follow);
};
requestAnimationFrame(follow);
window.dispatchEvent(new Event("resize"));
