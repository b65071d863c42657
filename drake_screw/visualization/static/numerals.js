// Numerals of demonstrations lie on the table; they stand upright in the picture wherever the
// camera is: their tops point to where the table meets the upright plane through the eye and them.
{
  const turn = () => {
    const m = viewer.camera.matrixWorld.elements;
    const [eye, up] = [[m[12], -m[14], m[13]], [m[4], -m[6], m[5]]];  // in the world
    const shown = viewer.scene_tree.children.demonstrations?.children ?? {};
    for (const [name, demonstration] of Object.entries(shown)) {
      const now = demonstration.children.place?.children.number?.object.matrix.elements;
      if (!now) continue;
      const [x, y, z] = [now[12] - eye[0], now[13] - eye[1], now[14] - eye[2]];
      const normal = [y * up[2] - z * up[1], z * up[0] - x * up[2]], size = Math.hypot(...normal);
      if (size < 1e-9) continue;
      let [c, s] = normal.map((v) => v / size);  // from left to right
      if (x * s - y * c > 0) [c, s] = [-c, -s];
      if (Math.hypot(now[0] - c, now[1] - s) < 1e-3) continue;
      viewer.set_transform(["demonstrations", name, "place", "number"],
        [c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, now[12], now[13], now[14], 1]);
      viewer.set_dirty();
    }
    requestAnimationFrame(turn);
  };
  requestAnimationFrame(turn);
}
