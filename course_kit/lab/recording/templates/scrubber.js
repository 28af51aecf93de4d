const figure = this.closest('figure'), now = Number(this.value);
const steps = figure.querySelectorAll('.ck-step'), words = figure.querySelectorAll('li');
const first = steps.length - words.length;
steps.forEach((step, at) => {
  step.classList.toggle('ck-later', at - first >= now);
  step.classList.toggle('ck-current', at - first === now - 1);
});
const said = words[now - 1].textContent;
figure.querySelector('output').textContent = now + ' of ' + this.max;
figure.querySelector('.ck-now').textContent = said;
this.setAttribute('aria-valuetext', now + ' of ' + this.max + ': ' + said);
