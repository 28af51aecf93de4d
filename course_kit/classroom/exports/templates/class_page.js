'use strict';
const told = document.getElementById('told');
const keyOf = cell => cell.dataset.value ?? cell.textContent.trim();
const inAlphabet = new Intl.Collator(undefined, {numeric: true, sensitivity: 'base'});

function compare(a, b) {
  const [x, y] = [Number(a), Number(b)];
  return Number.isNaN(x) || Number.isNaN(y) ? inAlphabet.compare(a, b) : x - y;
}

function sort(table, heading, column) {
  const descending = heading.getAttribute('aria-sort') === 'ascending';
  const rows = [...table.tBodies[0].rows].map(row => [keyOf(row.cells[column]), row]);
  rows.sort(([a], [b]) => {
    if (a === '' || b === '') return (a === '') - (b === ''); // what is not there comes last, whichever way
    return descending ? compare(b, a) : compare(a, b);
  });
  table.tBodies[0].append(...rows.map(([, row]) => row));
  for (const one of table.tHead.rows[0].cells) one.removeAttribute('aria-sort');
  heading.setAttribute('aria-sort', descending ? 'descending' : 'ascending');
  told.textContent = `Sorted by ${heading.textContent}, ${descending ? 'descending' : 'ascending'}.`;
}

for (const table of document.querySelectorAll('table.sortable')) {
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.title = 'Sort by this column';
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener('click', () => sort(table, heading, column));
  });
}

const find = document.getElementById('find');
if (find) {
  const rows = [...document.getElementById('class').tBodies[0].rows];
  const texts = rows.map(row => row.textContent.toLowerCase());
  find.closest('.find').hidden = false;
  find.addEventListener('input', () => {
    const wanted = find.value.trim().toLowerCase();
    let count = 0;
    rows.forEach((row, number) => {
      row.hidden = !texts[number].includes(wanted);
      count += !row.hidden;
    });
    document.getElementById('found').textContent = wanted ? `${count} of ${rows.length}` : '';
  });
}

let folded = [];
addEventListener('beforeprint', () => {
  folded = [...document.querySelectorAll('details:not([open])')];
  for (const one of folded) one.open = true;
});
addEventListener('afterprint', () => { for (const one of folded) one.open = false; });
