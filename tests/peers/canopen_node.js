// A node made with the package `canopen` of npm. Frames and orders are lines: `f ID HEX` is a frame, in either direction;
// `o JSON` an order from the test, `a JSON` what came of it, or what the node noticed.
const readline = require('readline');
const path = require('path');
const { Device, DataType, AccessType, ObjectType, EmcyType } = require(path.join(process.argv[2], 'node_modules', 'canopen'));

const role = process.argv[3];
const id = Number(process.argv[4]);
const tell = (what) => process.stdout.write(`a ${JSON.stringify(what, (_, v) => (typeof v === 'bigint' ? v.toString() : v))}\n`);
const device = new Device(role === 'slave' ? { enableLss: true } : { id });
device.on('message', (m) => process.stdout.write(`f ${m.id.toString(16)} ${Buffer.from(m.data).toString('hex')}\n`));

function addObjects(eds) {
    const add = (index, parameterName, dataType, defaultValue, accessType = AccessType.READ_WRITE) =>
        eds.addEntry(index, { parameterName, dataType, defaultValue, accessType });
    eds.setIdentity({ vendorId: 0x11223344, productCode: 2, revisionNumber: 3, serialNumber: 4 });
    add(0x2000, 'u8', DataType.UNSIGNED8, 0x12);
    add(0x2001, 'i16', DataType.INTEGER16, -2);
    add(0x2002, 'u32', DataType.UNSIGNED32, 0xDEADBEEF);
    add(0x2003, 'i64', DataType.INTEGER64, -5n);
    add(0x2004, 'text', DataType.VISIBLE_STRING, 'a text that takes several segments of seven bytes');
    add(0x2005, 'read only', DataType.UNSIGNED16, 7, AccessType.READ_ONLY);
    add(0x2006, 'bytes', DataType.OCTET_STRING, Buffer.alloc(1));
    add(0x2007, 'real', DataType.REAL32, 1.5);
    eds.addSdoServerParameter(id, 0x580 + id, 0x600 + id);
    eds.setHeartbeatProducerTime(100);
    eds.setEmcyCobId(0x80 + id);
    eds.addTransmitPdo({ cobId: 0x180 + id, transmissionType: 254, dataObjects: [eds.getEntry(0x2000), eds.getEntry(0x2001)] });
    eds.addReceivePdo({ cobId: 0x200 + id, dataObjects: [eds.getEntry(0x2002)] });
}

const orders = {
    set: ({ index, value }) => device.setValue(index, value),
    get: ({ index }) => device.getValue(index),
    emcy: ({ code, info }) => device.emcy.write(code, Buffer.from(info, 'hex')),  // Its form with one object sends code 0.
    state: () => device.state,
    upload: async ({ index, sub, type, block }) => {
        const data = await device.sdo.upload({ serverId: device.peer, index, subIndex: sub, dataType: DataType[type], timeout: 2000, blockTransfer: block });
        return Buffer.isBuffer(data) ? data.toString('hex') : data;
    },
    download: ({ index, sub, type, value, block }) =>
        device.sdo.download({
            serverId: device.peer, index, subIndex: sub, timeout: 2000, blockTransfer: block,
            data: type ? value : Buffer.from(value, 'hex'), dataType: type ? DataType[type] : undefined,
        }),
    nmt: ({ command }) => device.nmt[command](device.peer),
    fastscan: () => device.lss.fastscan({ timeout: 50 }),
    configureNodeId: ({ node }) => device.lss.configureNodeId(node, 200),
    inquireSerialNumber: () => device.lss.inquireSerialNumber(200),
    lssMode: ({ mode }) => device.lss.setMode(mode),
};

if (role === 'slave') {
    device.eds.setIdentity({ vendorId: 0x11223344, productCode: 2, revisionNumber: 3, serialNumber: 4 });
    device.lss.on('changeDeviceId', (node) => tell({ event: 'node', node }));
} else if (role === 'node') {
    addObjects(device.eds);
    device.start();
} else {
    device.peer = Number(process.argv[5]);
    device.eds.addSdoClientParameter(device.peer, 0x600 + device.peer, 0x580 + device.peer);
    device.eds.addEmcyConsumer(0x80 + device.peer);
    device.eds.addHeartbeatConsumer(device.peer, 1000);
    device.emcy.on('emergency', ({ cobId, em }) => tell({ event: 'emcy', cobId, code: em.code, register: em.register, info: em.info.toString('hex') }));
    device.nmt.on('heartbeat', ({ deviceId, state }) => tell({ event: 'heartbeat', node: deviceId, state }));
    device.start();
    device.nmt.startNode(id);
}

readline.createInterface({ input: process.stdin }).on('line', async (line) => {
    const [kind, ...rest] = line.split(' ');
    if (kind === 'f') {
        const data = Buffer.from(rest[1] || '', 'hex');
        device.receive({ id: parseInt(rest[0], 16), data, len: data.length });
        return;
    }
    const order = JSON.parse(line.slice(2));
    try {
        tell({ order: order.order, result: await orders[order.order](order) });
    } catch (error) {
        tell({ order: order.order, error: String(error.message || error), code: error.code });
    }
}).on('close', () => process.exit(0));
tell({ event: 'ready' });
