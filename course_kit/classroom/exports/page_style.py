"""How the class page looks: on a screen by day and by night, and on paper."""

from __future__ import annotations

STYLE = """
:root{color-scheme:light dark;--ground:#f6f7f9;--sheet:#fff;--ink:#1b1f24;--quiet:#555d68;--line:#d3d8de;
--link:#0b4fc4;--good:#1f7a4d;--bad:#c2571a;--hot:#f5a142;--mark:#1b1f24;--note:#fff3d6;--note-line:#b27400}
@media (prefers-color-scheme:dark){:root{--ground:#14171b;--sheet:#1c2026;--ink:#e8eaed;--quiet:#aab2bd;
--line:#3a414b;--link:#8ab8ff;--good:#3fae78;--bad:#e0813f;--hot:#a85f00;--mark:#e8eaed;--note:#332708;
--note-line:#d9a441}}
*{box-sizing:border-box}
html{scroll-behavior:smooth}
@media (prefers-reduced-motion:reduce){html{scroll-behavior:auto}}
body{margin:0;background:var(--ground);color:var(--ink);font:16px/1.5 system-ui,"Segoe UI",Roboto,sans-serif}
.skip{position:absolute;left:-100em}
.skip:focus{left:1em;top:.5em;background:var(--sheet);padding:.4em .8em;z-index:9}
header,main,footer{max-width:74rem;margin:0 auto;padding:0 1.2rem}
header{padding-top:1.6rem}
h1{font-size:1.9rem;line-height:1.2;margin:0 0 .8rem}
h2{font-size:1.3rem;margin:0 0 .6rem}
h3{font-size:1.05rem;margin:1.2rem 0 .4rem}
p{margin:.4rem 0 .8rem;max-width:46rem}
a{color:var(--link)}
a:focus-visible,button:focus-visible,input:focus-visible,summary:focus-visible,.wide:focus-visible{
outline:3px solid var(--link);outline-offset:2px}
section{background:var(--sheet);border:1px solid var(--line);border-radius:10px;padding:1.1rem 1.3rem;margin:1.1rem 0}
nav ul{display:flex;flex-wrap:wrap;gap:.3rem 1.2rem;list-style:none;margin:1rem 0 0;padding:0}
.facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(7.5rem,1fr));gap:.7rem;margin:0 0 .8rem}
.facts div{background:var(--sheet);border:1px solid var(--line);border-radius:10px;padding:.5rem .9rem .6rem}
.facts dt{color:var(--quiet);font-size:.85rem}
.facts dd{margin:0;font-size:1.45rem;font-weight:650;line-height:1.25;overflow-wrap:anywhere}
.note{background:var(--note);border-left:5px solid var(--note-line);border-radius:4px;padding:.6rem .9rem;
margin:.6rem 0 1rem;max-width:none}
.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(26rem,100%),1fr));gap:1.2rem}
figure{margin:0}
figcaption{font-weight:600;margin-bottom:.2rem}
figcaption small{display:block;font-weight:400;color:var(--quiet);font-size:.9rem}
svg{display:block;width:100%;max-width:44rem;height:auto}
svg text{fill:var(--ink);font-size:13px;text-anchor:middle}
svg text.label,svg text.unit{fill:var(--quiet)}
svg.defs{position:absolute}
svg .reached{fill:var(--good)}
svg .below{fill:var(--bad)}
svg .hatch{stroke:var(--sheet);stroke-width:2}
svg .axis{stroke:var(--quiet)}
svg .mark{stroke:var(--mark);stroke-width:1.5;stroke-dasharray:5 4}
.wide{overflow-x:auto;margin:.3rem 0 .9rem}
table{border-collapse:collapse;font-size:.93rem;font-variant-numeric:tabular-nums;min-width:min(34rem,100%)}
caption{text-align:left;font-weight:600;padding:.2rem 0 .5rem}
th,td{border-bottom:1px solid var(--line);padding:.34rem .7rem;text-align:left;vertical-align:top}
thead th{border-bottom:2px solid var(--quiet);white-space:nowrap;vertical-align:bottom}
tbody th{font-weight:500;overflow-wrap:anywhere;min-width:11rem;max-width:26rem}
td{max-width:30rem;overflow-wrap:anywhere}
#class.named td:nth-child(2){min-width:11rem}
td.number,thead th.number{text-align:right;white-space:nowrap}
tbody tr:hover>*{background:color-mix(in srgb,var(--link) 8%,transparent)}
td.heat,tbody tr:hover>td.heat{background:color-mix(in srgb,var(--hot) var(--heat),transparent);text-align:right}
thead button{font:inherit;color:inherit;background:none;border:0;padding:.1rem .2rem;margin:-.1rem -.2rem;
cursor:pointer;border-radius:4px}
thead button::after{content:" \\2195";color:var(--quiet)}
th[aria-sort=ascending] button::after{content:" \\2191";color:inherit}
th[aria-sort=descending] button::after{content:" \\2193";color:inherit}
code{font-family:ui-monospace,Menlo,Consolas,monospace;font-size:.92em}
.meter{display:inline-block;width:7rem;height:.75rem;border:1px solid var(--quiet);border-radius:3px;overflow:hidden;
vertical-align:-.06rem}
.meter>span{display:block;height:100%;background:var(--bad)}
.state{white-space:nowrap}
.meter+.share{display:inline-block;min-width:3.2em}
.find{margin:.2rem 0 .6rem;display:flex;flex-wrap:wrap;gap:.3rem .8rem;align-items:center}
.find input{font:inherit;color:inherit;background:var(--ground);border:1px solid var(--quiet);border-radius:6px;
padding:.3rem .6rem;min-width:16rem}
.quiet,footer{color:var(--quiet)}
footer{padding-bottom:2rem;font-size:.9rem}
summary{cursor:pointer}
[hidden]{display:none!important}
@media print{
:root{--ground:#fff;--sheet:#fff;--ink:#000;--quiet:#333;--line:#999;--link:#000;--mark:#000}
body{font-size:10pt}nav,.find,.skip,thead button::after{display:none!important}
section{border:0;padding:0;break-inside:auto}h2,h3,caption,figcaption{break-after:avoid}
tr,figure{break-inside:avoid}.wide{overflow:visible}thead{display:table-header-group}
svg,.meter>span,td.heat{print-color-adjust:exact;-webkit-print-color-adjust:exact}
a{text-decoration:none}}
"""
