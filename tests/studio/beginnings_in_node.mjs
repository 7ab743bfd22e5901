// Prints the programs behind the pictures of the start screen, with their robots and worlds.

const { BEGINNINGS } = await import(`${process.argv[2]}/start/beginnings.js`);
console.log(JSON.stringify(BEGINNINGS));
