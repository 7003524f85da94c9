"use strict";
// Folds the instruction sheets (paper has them open) and shows one plan at a time; without this script all of it stands on the page.
(() => {
  const sheets = [...document.querySelectorAll(".sheet")];
  for (const sheet of sheets) sheet.open = false;
  let unfolded = [];
  window.addEventListener("beforeprint", () => {
    unfolded = sheets.filter((sheet) => !sheet.open);
    for (const sheet of unfolded) sheet.open = true;
  });
  window.addEventListener("afterprint", () => { for (const sheet of unfolded) sheet.open = false; });
  const plans = [...document.querySelectorAll(".plan")];
  const button = document.getElementById("all");
  if (plans.length < 2) return;
  let all = false;
  const wanted = () => {
    const asked = /^#plan-(\d+)$/.exec(location.hash);
    return asked && Number(asked[1]) <= plans.length ? asked[1] : document.body.dataset.opens;
  };
  const show = () => {
    const chosen = wanted();
    for (const plan of plans) {
      plan.hidden = !all && plan.dataset.plan !== chosen;
      plan.classList.toggle("chosen", plan.dataset.plan === chosen); // the one that is printed
    }
    for (const mark of document.querySelectorAll("[data-plan]:not(.plan)")) {
      if (mark.dataset.plan === chosen) mark.setAttribute("aria-current", "true");
      else mark.removeAttribute("aria-current");
    }
    button.textContent = all ? button.dataset.single : button.dataset.all;
  };
  button.hidden = false;
  button.addEventListener("click", () => { all = !all; document.getElementById("print-plans").checked = all; show(); });
  window.addEventListener("hashchange", () => {
    show();
    const target = document.getElementById("plan-" + wanted());
    if (target) target.scrollIntoView({ block: "start" });
  });
  for (const row of document.querySelectorAll("tr[data-plan]")) {
    row.style.cursor = "pointer";
    row.addEventListener("click", () => { location.hash = "plan-" + row.dataset.plan; });
  }
  show();
})();
