// Where others find a page, and from where an address can be opened.

const HERE_HOST = /^(.*\.)?localhost$|^127(\.\d+){3}$|^\[::1\]$/;
const NETWORK_HOST = /^(10\.\d+|192\.168|172\.(1[6-9]|2\d|3[01])|169\.254)(\.\d+){2}$|^\[f([cd]|e[89ab])|\.local$|^[^.[]+$/;

/** @param {string} address */
export function isAddress(address) {
  return URL.canParse(address) && /^https?:$/.test(new URL(address).protocol);
}

/**
 * @param {string} address
 * @returns {'here' | 'network' | 'anywhere'} on this computer alone, in its network, or wherever there is one
 */
export function reachOf(address) {
  const { hostname } = new URL(address);
  return HERE_HOST.test(hostname) ? 'here' : NETWORK_HOST.test(hostname) ? 'network' : 'anywhere';
}
