/**
 * The server as functions. Every answer is a status and a document; a server that cannot be reached
 * raises `Unreachable` and is asked again until it is back.
 * @module
 */
import { readAnswer, writeRequest } from "./ordered.js";
import { signal } from "./view.js";

const token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
const SECONDS_BETWEEN_ASKING = 2;

/** True while the server answers. */
export const connected = signal(true);

export class Unreachable extends Error {}

/**
 * @param {string} method
 * @param {string} path
 * @param {Record<string, any>} [body]
 * @returns {Promise<{status: number, document: any}>}
 */
async function ask(method, path, body) {
  const answer = await reach(method, path, body && writeRequest(body), "application/json");
  const text = await answer.text();
  try {
    return { status: answer.status, document: readAnswer(text) };
  } catch {
    return { status: answer.status, document: { error: text.slice(0, 300) || answer.statusText } };
  }
}

/**
 * @param {string} method
 * @param {string} path
 * @param {BodyInit | undefined} body
 * @param {string} type
 */
async function reach(method, path, body, type) {
  // What is only read needs no token, and what the first page has asked for in advance has none.
  /** @type {Record<string, string>} */
  const headers = method === "GET" ? {} : { "X-Tandem-Token": token };
  if (body) headers["Content-Type"] = type;
  try {
    const answer = await fetch(path, { method, body, headers });
    connected.value = true;
    return answer;
  } catch (error) {
    if (connected.value) askUntilBack();
    connected.value = false;
    throw new Unreachable("the server does not answer", { cause: error });
  }
}

function askUntilBack() {
  setTimeout(async () => {
    try {
      await fetch("/api/health");
      connected.value = true;
    } catch {
      askUntilBack();
    }
  }, SECONDS_BETWEEN_ASKING * 1000);
}

export const health = () => ask("GET", "/api/health");
export const listFiles = () => ask("GET", "/api/files");
/** @param {string} [name] a file of the folder, else the first. */
export const readCell = (name) => ask("GET", `/api/cell${name ? `?${new URLSearchParams({ file: name })}` : ""}`);
/** @param {string} name @param {Record<string, any>} body */
export const writeCell = (name, body) => ask("PUT", `/api/cell?${new URLSearchParams({ file: name })}`, body);
/** Holds what is not saved, so that the server keeps it when it is stopped; without a cell, forgets it. @param {Record<string, any>} body */
export const hold = (body) => ask("POST", "/api/draft", body);
/** @param {Record<string, any>} body */
export const check = (body) => ask("POST", "/api/check", body);
/** @param {Record<string, any>} body */
export const place = (body) => ask("POST", "/api/place", body);
/** @param {Record<string, any>} body */
export const replan = (body) => ask("POST", "/api/replan", body);
/** @param {Record<string, any>} body */
export const explain = (body) => ask("POST", "/api/explain", body);
/** How a schedule fares, and what differs from another. @param {Record<string, any>} body */
export const measures = (body) => ask("POST", "/api/measures", body);
/** What differs between `cell` and `other`. @param {Record<string, any>} body */
export const compare = (body) => ask("POST", "/api/compare", body);
/** Which of some points is recommended. @param {Record<string, any>} body */
export const recommend = (body) => ask("POST", "/api/recommend", body);
/** Where the precedence graph's tasks stand. @param {Record<string, any>} body */
export const graph = (body) => ask("POST", "/api/graph", body);
/** The document of a plan, without what is found on the way. @param {Record<string, any>} body */
export const plan = (body) => ask("POST", "/api/plan", body);
export const stopPlan = () => ask("POST", "/api/plan/stop", {});

/**
 * What a workbook says.
 * @param {[string, string][]} query `name`, `lang`, and what was said of it by hand. @param {ArrayBuffer} workbook
 */
export async function importWorkbook(query, workbook) {
  const answer = await reach("POST", `/api/import?${new URLSearchParams(query)}`, workbook, "application/octet-stream");
  return { status: answer.status, document: readAnswer(await answer.text()) };
}

/**
 * The report's file.
 * @param {Record<string, any>} body
 */
export async function report(body) {
  return reach("POST", "/api/report", writeRequest(body), "application/json");
}

/**
 * Plans a cell, with what is found as it is found.
 * @param {Record<string, any>} body `cell`, the options of `tandem plan` and the language.
 * @param {{progress: (data: any) => void, done: (data: any) => void, failed: (data: any) => void, lost: () => void}} hear
 */
export async function planLive({ cell, options, lang, file, version }, hear) {
  const { status, document } = await ask("POST", "/api/draft", { cell, file, version });
  if (status !== 200) return hear.failed({ message: document.error, errors: document.errors });
  const query = new URLSearchParams({ ...options, lang, draft: document.draft, token });
  const source = new EventSource(`/api/plan/stream?${query}`);
  /** @param {string} name @param {(data: any) => void} act @param {boolean} last */
  const on = (name, act, last) =>
    source.addEventListener(name, (event) => {
      // A closed stream would be opened again by the browser, and plan anew.
      if (last) source.close();
      act(JSON.parse(/** @type {MessageEvent} */ (event).data));
    });
  on("progress", hear.progress, false);
  on("done", hear.done, true);
  on("failed", hear.failed, true);
  source.onerror = () => {
    source.close();
    hear.lost();
  };
}
