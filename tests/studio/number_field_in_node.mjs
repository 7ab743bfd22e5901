// Types numbers into the field of a block: prints what each text gives.

import { createInterface } from 'node:readline';
import { blocklyInNode } from './blockly_in_node.mjs';
import { freshPage } from './page_in_node.mjs';

const page = freshPage({ blockly: blocklyInNode().blockly });
const { NumberField } = await page.load('blocks/fields.js');
for await (const typed of createInterface({ input: process.stdin })) {
  const field = new NumberField(7);
  field.setValue(JSON.parse(typed));
  console.log(JSON.stringify([field.getValue(), field.textValue()]));
}
