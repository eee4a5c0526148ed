
for (const table of document.querySelectorAll('table.sortable')) {
  table.querySelectorAll('th').forEach((heading, column) => {
    heading.dataset.sort = '';
    heading.addEventListener('click', () => {
      const down = heading.dataset.sort === 'up';
      table.querySelectorAll('th').forEach(other => { other.dataset.sort = ''; });
      heading.dataset.sort = down ? 'down' : 'up';
      const key = row => row.cells[column].textContent;
      const order = (a, b) => {
        const [x, y] = [parseFloat(key(a)), parseFloat(key(b))];
        if (isNaN(x) && isNaN(y)) return key(a).localeCompare(key(b));
        if (isNaN(x)) return 1;
        if (isNaN(y)) return -1;
        return x - y;
      };
      const rows = [...table.tBodies[0].rows].sort(order);
      if (down) rows.reverse();
      table.tBodies[0].append(...rows);
    });
  });
}
