"""How the card of a report looks, in the colours of JupyterLab's theme, with colours of its own elsewhere."""

from __future__ import annotations

STYLE = """
.course-kit-report{font-family:var(--jp-ui-font-family,system-ui,sans-serif);font-size:var(--jp-ui-font-size1,13px);
line-height:1.5;border:1px solid var(--jp-border-color1,#888);border-radius:4px;padding:.7em 1em;max-width:60em;
box-sizing:border-box;color:var(--jp-ui-font-color1,#111);background:var(--jp-layout-color1,#fff);
--ck-good:var(--jp-success-color1,#1a7f37);--ck-bad:var(--jp-error-color1,#b3261e);
--ck-quiet:var(--jp-ui-font-color2,#555)}
.course-kit-report h3{margin:0 0 .3em;font-size:1.15em}
.course-kit-report p{margin:.3em 0}
.course-kit-report .ck-walls{color:var(--ck-quiet);font-size:.92em;margin-top:.6em}
.course-kit-report ol.ck-checks{list-style:none;margin:.5em 0;padding:0}
.course-kit-report ol.ck-checks>li{border-left:.3em solid var(--jp-border-color1,#888);margin:.2em 0;padding:.1em .6em}
.course-kit-report ol.ck-checks>li.passed{border-left-color:var(--ck-good)}
.course-kit-report ol.ck-checks>li.failed,.course-kit-report ol.ck-checks>li.error{
border-left-color:var(--ck-bad);border-left-style:double}
.course-kit-report ol.ck-checks>li.skipped{border-left-style:dotted}
.course-kit-report .ck-head{display:flex;gap:.5em;align-items:baseline}
.course-kit-report summary{cursor:pointer}
.course-kit-report summary:focus-visible,.course-kit-report a:focus-visible{
outline:2px solid var(--jp-brand-color1,#1976d2);outline-offset:2px}
.course-kit-report summary.ck-head::before{content:"\\25B8";color:var(--ck-quiet);flex:none}
.course-kit-report details[open]>summary.ck-head::before{content:"\\25BE"}
.course-kit-report div.ck-head::before{content:"\\25B8";visibility:hidden;flex:none}
.course-kit-report .ck-sign{flex:none;width:1em;text-align:center;font-weight:700}
.course-kit-report .ck-title{flex:1;overflow-wrap:anywhere}
.course-kit-report .ck-state{color:var(--ck-quiet)}
.course-kit-report .ck-place{flex:none;width:6em;align-self:center;line-height:0}
.course-kit-report .ck-bar{display:inline-block;height:.6em;min-width:.4em;border:1px solid var(--ck-quiet);
border-radius:2px;box-sizing:border-box;overflow:hidden;vertical-align:middle;
background:repeating-linear-gradient(135deg,transparent 0 3px,var(--jp-border-color2,#bbb) 3px 4px)}
.course-kit-report .ck-bar.ck-total{width:14em;height:.8em;margin-left:.4em}
.course-kit-report .ck-bar>span{display:block;height:100%;background:var(--ck-good)}
.course-kit-report dl{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.15em .9em;margin:.35em 0 .5em}
.course-kit-report dt,.course-kit-report dd{float:none;width:auto;padding:0;margin:0}
.course-kit-report dt{font-weight:600}
.course-kit-report dd{overflow-wrap:anywhere}
.course-kit-report code{background:var(--jp-layout-color2,#eee);color:inherit;padding:0 .25em;border-radius:2px;
overflow-wrap:anywhere}
.course-kit-report a:link,.course-kit-report a:visited{color:var(--jp-content-link-color,#0b57d0);
text-decoration:underline}
.course-kit-report pre{white-space:pre-wrap;overflow-wrap:anywhere;max-height:14em;overflow:auto;margin:.3em 0}
.course-kit-report .ck-exchange{margin:.4em 0}
.course-kit-report .ck-exchange ol{margin:.2em 0;padding-left:2em}
.course-kit-report svg.ck-sequence{display:block;max-width:100%;height:auto;color:var(--jp-ui-font-color1,#111);
font:12px var(--jp-code-font-family,monospace)}
.course-kit-report .ck-sequence text{fill:currentColor}
.course-kit-report .ck-sequence text.ck-note{fill:var(--ck-quiet);font-style:italic}
.course-kit-report .ck-sequence text.ck-failure{font-weight:700}
.course-kit-report .ck-sequence .ck-box{fill:none;stroke:currentColor}
.course-kit-report .ck-sequence .ck-life{stroke:var(--ck-quiet);stroke-dasharray:2 4}
.course-kit-report .ck-sequence .ck-arrow{fill:none;stroke:currentColor;stroke-width:1.3}
.course-kit-report .ck-sequence .ck-filled{fill:currentColor}
.course-kit-report .ck-sequence .ck-fail{fill:none;stroke:var(--ck-bad);stroke-width:2}
.course-kit-report .ck-sequence .ck-back{stroke-dasharray:6 4}
.course-kit-report .ck-hint{margin:.3em 0}
.course-kit-report .ck-hint .ck-hint{margin-left:1em}
.course-kit-report ol.ck-checks>li>details>:not(summary){margin-left:1.4em}
"""
