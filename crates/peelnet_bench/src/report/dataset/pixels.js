
for (const view of document.querySelectorAll('.pixels')) {
  const { width, height, columns, cells } = JSON.parse(view.querySelector('script').textContent);
  const [image, mark, which, note, body] =
    ['img', '.mark', '.which', '.note', 'tbody'].map(name => view.querySelector(name));
  let kept = false;
  const show = event => {
    const box = image.getBoundingClientRect();
    const cell = (at, size, n) => Math.min(n - 1, Math.max(0, Math.floor(at / size * n)));
    const x = cell(event.clientX - box.left, box.width, width);
    const y = cell(event.clientY - box.top, box.height, height);
    mark.hidden = false;
    mark.style.cssText = `left:${100 * x / width}%;top:${100 * y / height}%;width:${100 / width}%;height:${100 / height}%`;
    const [column, row, count, values] = cells[y * width + x] ?? [0, 0, 0, []];
    const shown = values.length / columns;
    note.textContent = count > shown ? `, the first ${shown} below` : '';
    which.textContent = count ? `Pixel (${column}, ${row}): ${count} ${count === 1 ? 'row' : 'rows'}` : 'No rows here';
    body.replaceChildren(...Array.from({ length: shown }, (_, k) => {
      const line = document.createElement('tr');
      for (const value of values.slice(k * columns, (k + 1) * columns)) {
        line.insertCell().textContent = String(value);
      }
      return line;
    }));
  };
  image.addEventListener('pointermove', event => { if (!kept) show(event); });
  image.addEventListener('click', event => { kept = !kept; show(event); });
}
