"""What the host reads of a message that a sink's radio has received, by the kind of sink (zstack.md, section 1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from wsn_tracking.errors import TrackingError
from wsn_tracking.zstack.commands import AfIncomingMsg, MtAppRsp, encode
from wsn_tracking.zstack.device import Device
from wsn_tracking.zstack.frames import encode_frame
from wsn_tracking.zstack.lines import encode_line
from wsn_tracking.zstack.motes import Message
from wsn_tracking.zstack.protocols import Radio
from wsn_tracking.zstack.readings import AirEpoch, range_record
from wsn_tracking.zstack.reports import Report

Uplink = Callable[[Message, float], list[bytes]]  # message and time -> what is written, each as a whole


def uplink_of(protocol: str, device: Device, radio: Radio) -> Uplink:
    """The way of one kind of sink."""
    if protocol == 'ascii':
        return lambda message, now: _lines(message, radio)
    if protocol == 'mt_app':
        return lambda message, now: _app_frames(message, radio)
    return lambda message, now: _znp_frames(message, now, device, radio)


def check_carries(protocol: str, payload: str, epochs: Sequence[AirEpoch]) -> None:
    """TrackingError where what is to be sent was not measured, fits no record, or is nothing for that kind of sink."""
    readings = [reading for epoch in epochs for reading in epoch.readings]
    ranges = [r for r in readings if payload == 'range' or (payload == 'auto' and r.rssi_dbm is None)]
    if protocol == 'ascii' and (payload in {'range', 'worn'} or ranges):
        raise TrackingError('sink_protocol ascii carries signal strengths of robots only: choose znp or mt_app')
    for reading in ranges:
        range_record(reading, 0, 0, 0)
    if payload in {'rssi', 'worn'} and readings and all(reading.rssi_dbm is None for reading in readings):
        raise TrackingError(f'traffic.payload {payload}: no signal strength was measured, choose range or auto')


def _znp_frames(message: Message, now: float, device: Device, radio: Radio) -> list[bytes]:
    endpoints = device.chip.endpoints
    if message.endpoint != radio.endpoint and radio.endpoint in endpoints:  # another application of the host has it
        endpoints.setdefault(message.endpoint, endpoints[radio.endpoint]._replace(endpoint=message.endpoint))
    incoming = AfIncomingMsg(
        group=0,
        cluster=message.cluster,
        src=message.src,
        src_endpoint=message.endpoint,
        dst_endpoint=message.endpoint,
        was_broadcast=int(message.was_broadcast),
        lqi=message.lqi,
        security=0,
        timestamp=0,
        trans_seq=0,
        data=message.bytes,
        mac_src=message.mac_src,
        radius=max(radio.default_radius - message.hops, 0),
    )
    return [encode_frame(frame) for frame in device.incoming(incoming, now)]


def _app_frames(message: Message, radio: Radio) -> list[bytes]:
    if message.cluster != radio.cluster:
        return []
    return [encode_frame(encode(MtAppRsp(message.endpoint, message.bytes)))]


def _lines(message: Message, radio: Radio) -> list[bytes]:
    if (message.cluster, message.endpoint) != (radio.cluster, radio.endpoint):
        return []
    payload = message.payload
    parts = [payload._replace(records=(record,)) for record in payload.records] or [payload]
    lines = [encode_line(Report(part, lqi=message.lqi, hops=message.hops)) for part in parts]
    if message.data is None:
        return lines
    return [line.replace(b'*', b'#') for line in lines]  # damaged
