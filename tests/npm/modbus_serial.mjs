// SPDX-License-Identifier: Apache-2.0
// usage: modbus_serial.mjs PORT COUNT     input registers 0 to COUNT - 1 of 127.0.0.1, and the floats at 8 and 20
import {createRequire} from "node:module";

const ModbusRTU = createRequire(`${process.env.STRAINWAVE_NPM}/`)("modbus-serial");
const client = new ModbusRTU();
await client.connectTCP("127.0.0.1", {port: Number(process.argv[2])});
client.setID(1);
client.setTimeout(30000);
const {data, buffer} = await client.readInputRegisters(0, Number(process.argv[3]));
console.log(JSON.stringify({registers: data, floats: [buffer.readFloatBE(16), buffer.readFloatBE(40)].map(String)}));
client.close(() => {});
