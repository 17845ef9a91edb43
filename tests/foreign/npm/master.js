// A master made of the npm package `canopen`: configures one DS402 drive, moves it by PDO, measures
// with its touch probe, brings it into fault and out again. Every line of stdin is an object
// {time_ms, frames: [[id, hex], ...]}, every line of stdout {frames: [...]} or, last, {report}.
'use strict';
const Module = require('module');
const readline = require('readline');

// The package computes the CRC of block transfers by a native module that has to be compiled; the
// same polynomial here (x^16 + x^12 + x^5 + 1, start 0)
const load = Module._load;
Module._load = function (request, ...rest) {
    if (request !== 'node-crc')
        return load.call(this, request, ...rest);
    return {
        crc: (...args) => {
            let crc = 0;
            for (const byte of args[args.length - 1]) {
                crc ^= byte << 8;
                for (let bit = 0; bit < 8; bit++)
                    crc = (crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1) & 0xFFFF;
            }
            return Buffer.from([crc >> 8, crc & 0xFF]);
        },
    };
};
const { Device, DataType, Eds, LssMode } = require('canopen');

const [, , edsFile, nodeText, planText] = process.argv;
const node = Number(nodeText);
const plan = JSON.parse(planText); // {target, home, latch_object}
const TIMEOUT_MS = 20000; // wall time: only a hung bench reaches it

let outgoing = [];
let timeMs = 0;
const waiting = [];
const report = { heartbeats: [], emergencies: [], aborts: {}, read: {}, steps: [] };

/** Resolve at the first instant of the bus at which `condition` holds. */
function until(condition, text, limitMs = 5000) {
    const end = timeMs + limitMs;
    return new Promise((resolve, reject) => waiting.push({ condition, resolve, reject, end, text }));
}

function wait(ms) {
    const end = timeMs + ms;
    return until(() => timeMs >= end, `${ms} ms`, ms + 1000);
}

const master = new Device({ id: 0x7F, eds: new Eds(), enableLss: true });
master.addListener('message', (m) => outgoing.push([m.id, m.data.toString('hex')]));
const { eds } = master;
eds.addHeartbeatConsumer(node, 10000);
eds.addEmcyConsumer(0x80 + node);
eds.addSdoClientParameter(node, 0x600 + node, 0x580 + node);
eds.setSyncCobId(0x80);
eds.setSyncGenerationEnable(true);

const entry = (index, name, dataType) => eds.addEntry(index, { parameterName: name, dataType, accessType: 'rw' });
const words = {
    control: entry(0x2000, 'controlword', DataType.UNSIGNED16),
    target: entry(0x2001, 'target', DataType.INTEGER32),
    probe: entry(0x2002, 'probe function', DataType.UNSIGNED16),
    status: entry(0x2010, 'statusword', DataType.UNSIGNED16),
    actual: entry(0x2011, 'actual', DataType.INTEGER32),
    probed: entry(0x2012, 'probe status', DataType.UNSIGNED16),
    latch: entry(0x2013, 'latch', DataType.INTEGER32),
};
eds.addTransmitPdo({
    cobId: 0x200 + node, transmissionType: 253, dataObjects: [words.control, words.target, words.probe],
});
eds.addReceivePdo({
    cobId: 0x180 + node, transmissionType: 1, dataObjects: [words.status, words.actual, words.probed],
});
eds.addReceivePdo({ cobId: 0x280 + node, transmissionType: 1, dataObjects: [words.latch] });

let command = { control: 0, target: 0, probe: 0 };
let cyclic = false;
let tpdos = 0;

function cycle() {
    if (!cyclic)
        return;
    for (const [name, value] of Object.entries(command))
        if (words[name].value !== value)
            words[name].value = value;
    master.sync.write();
    master.pdo.write(0x200 + node);
}

const read = (index, subIndex, dataType, blockTransfer = false) =>
    master.sdo.upload({ serverId: node, index, subIndex, dataType, blockTransfer, timeout: TIMEOUT_MS });
const write = (index, subIndex, data, dataType, blockTransfer = false) =>
    master.sdo.download({ serverId: node, index, subIndex, data, dataType, blockTransfer, timeout: TIMEOUT_MS });

async function refused(name, promise) {
    try {
        await promise;
        report.aborts[name] = 'accepted';
    } catch (error) {
        report.aborts[name] = String(error.code === undefined ? error.message : error.code);
    }
}

async function mapPdo(communication, mapping, cobId, type, entries) {
    await write(communication, 1, (cobId | 0x80000000) >>> 0, DataType.UNSIGNED32);
    await write(mapping, 0, 0, DataType.UNSIGNED8);
    for (let i = 0; i < entries.length; i++)
        await write(mapping, i + 1, entries[i], DataType.UNSIGNED32);
    await write(mapping, 0, entries.length, DataType.UNSIGNED8);
    await write(communication, 2, type, DataType.UNSIGNED8);
    await write(communication, 1, cobId, DataType.UNSIGNED32);
}

async function toState(control, mask, value, name) {
    command.control = control;
    await until(() => (words.status.value & mask) === value, name);
    report.steps.push(name);
}

async function layerSettings() {
    master.lss.switchModeGlobal(LssMode.CONFIGURATION);
    await wait(2);
    report.identity = [
        await master.lss.inquireVendorId(TIMEOUT_MS), await master.lss.inquireProductCode(TIMEOUT_MS),
        await master.lss.inquireRevisionNumber(TIMEOUT_MS), await master.lss.inquireSerialNumber(TIMEOUT_MS),
    ];
    master.lss.switchModeGlobal(LssMode.OPERATION);
    await wait(2);
    report.steps.push('identified');
}

async function configure() {
    report.read.deviceType = await read(0x1000, 0, DataType.UNSIGNED32);
    report.read.identities = [];
    for (const subIndex of [1, 2, 3, 4])
        report.read.identities.push(await read(0x1018, subIndex, DataType.UNSIGNED32));
    report.read.identity = await read(0x1018, 0, DataType.UNSIGNED8);
    report.read.modes = await read(0x6502, 0, DataType.UNSIGNED32);
    report.read.name = await read(0x1008, 0, DataType.VISIBLE_STRING);
    await refused('unknown object', read(0x2222, 0, DataType.UNSIGNED8));
    await refused('unknown sub-index', read(0x1018, 9, DataType.UNSIGNED8));
    await refused('write to read only', write(0x6041, 0, 1, DataType.UNSIGNED16));
    await refused('too long', write(0x6066, 0, 1, DataType.UNSIGNED32));
    await write(0x6065, 0, 4000000000, DataType.UNSIGNED32);
    report.read.window = await read(0x6065, 0, DataType.UNSIGNED32);
    await write(0x1006, 0, 1000, DataType.UNSIGNED32);
    await write(0x1017, 0, 20, DataType.UNSIGNED16);
    await mapPdo(0x1400, 0x1600, 0x200 + node, 1, [0x60400010, 0x607A0020, 0x60B80010]);
    await mapPdo(0x1800, 0x1A00, 0x180 + node, 1, [0x60410010, 0x60640020, 0x60B90010]);
    await mapPdo(0x1801, 0x1A01, 0x280 + node, 1, [plan.latch_object * 0x10000 + 0x20]);
    await write(0x6060, 0, 8, DataType.INTEGER8);
    report.steps.push('configured');
}

async function block() {
    try {
        report.read.nameByBlock = await read(0x1008, 0, DataType.VISIBLE_STRING, true);
    } catch (error) {
        report.read.nameByBlock = `refused ${error.code}`;
    }
    try {
        await write(0x6065, 0, 3000000000, DataType.UNSIGNED32, true);
        report.read.windowByBlock = await read(0x6065, 0, DataType.UNSIGNED32);
    } catch (error) {
        report.read.windowByBlock = `refused ${error.code}`;
    }
}

async function enable() {
    cyclic = true;
    await until(() => tpdos > 0, 'first TPDO');
    command.target = words.actual.value;
    await toState(0x06, 0x6F, 0x21, 'ready to switch on');
    await toState(0x07, 0x6F, 0x23, 'switched on');
    command.target = words.actual.value;
    await toState(0x0F, 0x6F, 0x27, 'operation enabled');
}

async function travel(target, step, done) {
    await until(() => {
        const rest = target - command.target;
        command.target += Math.sign(rest) * Math.min(Math.abs(rest), step);
        return done();
    }, `travel to ${target}`, 60000);
}

async function measure() {
    command.probe = 0;
    await until(() => (words.probed.value & 7) === 0, 'probe clear');
    command.probe = 0x11;
    await until(() => (words.probed.value & 1) === 1, 'probe armed');
    await travel(plan.target, plan.step, () => (words.probed.value & 2) !== 0);
    report.latched = words.latch.value;
    await travel(plan.home, 10 * plan.step, () => command.target === plan.home);
    report.latchedAfterwards = words.latch.value;
    command.probe = 0;
    await until(() => (words.probed.value & 7) === 0, 'probe off');
    report.steps.push('measured');
}

async function fault() {
    await write(0x6066, 0, 0, DataType.UNSIGNED16);
    await write(0x6065, 0, 1, DataType.UNSIGNED32);
    command.target += 100 * plan.step;
    await until(() => (words.status.value & 0x4F) === 0x08, 'fault');
    report.faultStatus = words.status.value;
    report.errorRegister = await read(0x1001, 0, DataType.UNSIGNED8);
    command.control = 0x80; // held: resets once
    await until(() => (words.status.value & 0x4F) === 0x40, 'fault reset');
    await write(0x6065, 0, 0xFFFFFFFF, DataType.UNSIGNED32);
    command.control = 0;
    command.target = words.actual.value;
    await enable();
    report.steps.push('fault reset');
}

async function main() {
    const sheet = Eds.fromFile(edsFile);
    report.edsObjects = [...sheet.entries()].length;
    report.edsVendor = sheet.vendorName;
    master.start();
    master.nmt.startNode();
    master.nmt.on('heartbeat', ({ state }) => report.heartbeats.push(state));
    master.emcy.on('emergency', ({ em }) => report.emergencies.push([em.code, em.register]));
    master.pdo.on('pdo', ({ cobId }) => { tpdos += cobId === 0x180 + node; });
    await wait(5);
    master.nmt.resetNode(node);
    await until(() => report.heartbeats.includes(0) || report.heartbeats.includes(127), 'boot-up');
    await layerSettings();
    await configure();
    await block();
    master.nmt.startNode(node);
    await until(() => report.heartbeats.includes(5), 'operational');
    await enable();
    await measure();
    await fault();
    await toState(0x06, 0x6F, 0x21, 'ready to switch on');
    master.nmt.stopNode(node);
    await until(() => report.heartbeats.includes(4), 'stopped');
    report.steps.push('stopped');
}

const tick = () => new Promise((resolve) => setImmediate(resolve));
const answer = (object) => process.stdout.write(`${JSON.stringify(object)}\n`);

async function serve() {
    let ended = null;
    main().then(() => { ended = 'done'; }, (error) => { ended = String(error.stack || error); });
    for await (const line of readline.createInterface({ input: process.stdin })) {
        const { time_ms: now, frames } = JSON.parse(line);
        timeMs = now;
        for (const [id, data] of frames)
            master.receive({ id, data: Buffer.from(data, 'hex'), len: data.length / 2 });
        await tick();
        for (const item of [...waiting]) {
            const holds = item.condition();
            if (holds || timeMs > item.end) {
                waiting.splice(waiting.indexOf(item), 1);
                if (holds)
                    item.resolve();
                else
                    item.reject(new Error(`did not come: ${item.text}`));
            }
        }
        await tick();
        cycle();
        await tick();
        const sent = outgoing;
        outgoing = [];
        if (ended !== null) {
            answer({ frames: sent, ended, report });
            break;
        }
        answer({ frames: sent });
    }
    process.exit(0);
}

serve();
