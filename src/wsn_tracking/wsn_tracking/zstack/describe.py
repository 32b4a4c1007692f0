"""Frames, reports and payloads in words."""

from __future__ import annotations

from typing import Any

from wsn_tracking.zstack.bad import Bad
from wsn_tracking.zstack.commands import AfDataRequest, Command, SysPingRsp, SysVersionRsp, decode, name_of
from wsn_tracking.zstack.frames import Frame, Kind
from wsn_tracking.zstack.lqi import Scale, strength_of
from wsn_tracking.zstack.payload import Flag, Payload, PayloadType, decode_payload
from wsn_tracking.zstack.protocols import Item
from wsn_tracking.zstack.records import FeedbackRecord, RangeRecord, Record, RssiRecord
from wsn_tracking.zstack.reports import Report

CAPABILITIES = ('SYS', 'MAC', 'NWK', 'AF', 'ZDO', 'SAPI', 'UTIL', 'DBG', 'APP')
TYPES = {
    PayloadType.RSSI: 'RSSI report',
    PayloadType.HEARTBEAT: 'heartbeat',
    PayloadType.RANGE: 'range report',
    PayloadType.WORN: 'worn-node report',
    PayloadType.FEEDBACK: 'position feedback',
    PayloadType.COMMAND: 'sensing command',
}
# fields that are addresses, masks or ids: in hexadecimal, with so many digits
HEX = {
    **dict.fromkeys(('ieee', 'ext_pan', 'parent_ieee'), 16),
    **dict.fromkeys(('short', 'src', 'dst', 'mac_src', 'parent', 'pan_id', 'cluster', 'profile', 'group', 'item'), 4),
    **dict.fromkeys(('relays', 'associated', 'in_clusters', 'out_clusters'), 4),
    **dict.fromkeys(('endpoint', 'src_endpoint', 'dst_endpoint', 'capability', 'bits', 'cmd0', 'cmd1'), 2),
    'mask': 8,
}


def describe(raw: Frame | bytes, item: Item, scale: Scale) -> str:
    """One line on a frame, or a line of text, that came from a sink or went to it."""
    if isinstance(raw, bytes):
        words = f'$WSN {describe_report(item, scale)}' if isinstance(item, Report) else repr(raw.decode('latin-1'))
    else:
        kind = Kind(raw.kind).name if raw.kind in set(Kind) else '?'
        words = f'{kind} {name_of(raw.header)} '
        words += describe_report(item, scale) if isinstance(item, Report) else describe_command(decode(raw))
    return f'{words.rstrip()} [{item.reason}: {item.detail}]' if isinstance(item, Bad) else words.rstrip()


def describe_command(command: Command | Bad) -> str:
    """The fields of a command."""
    if isinstance(command, Bad):
        return ''
    if isinstance(command, SysVersionRsp):
        return str(command)
    if isinstance(command, SysPingRsp):
        return ' '.join(name for bit, name in enumerate(CAPABILITIES) if command.capabilities >> bit & 1)
    if isinstance(command, AfDataRequest) and isinstance(payload := decode_payload(command.data), Payload):
        return f'to {command.dst:04X} transaction {command.trans_id}: {describe_payload(payload)}'
    fields: dict[str, Any] = command._asdict()  # type: ignore[attr-defined]
    return ' '.join(f'{name}={_value(name, value)}' for name, value in fields.items() if value is not None)


def describe_report(report: Report, scale: Scale) -> str:
    """A payload and how it came."""
    how = []
    if report.src is not None:
        how.append(f'from {report.src:04X}')
    if report.lqi is not None:
        strength = strength_of(report.lqi, scale)
        how.append(
            f'LQI {report.lqi} ({"<" * (strength.censored < 0)}{">" * (strength.censored > 0)}{strength.rssi_dbm} dBm)'
        )
    if report.hops is not None:
        how.append(f'{report.hops} hop' + 's' * (report.hops != 1))
    if report.ticks is not None:
        how.append(f'tick {report.ticks}')
    return ' '.join([describe_payload(report.payload), *(['|', *how] if how else [])])


def describe_payload(payload: Payload) -> str:
    """A payload and its records."""
    parts = [
        f'{TYPES[PayloadType(payload.type)]} node {payload.node_id} seq {_or(payload.seq)} t {_or(payload.t_ms)} ms'
    ]
    flags = [flag.name.lower().replace('_', ' ') for flag in Flag if payload.flags & flag and flag.name]
    parts += [', '.join(flags)] if flags else []
    parts += [f'{payload.battery_mv} mV'] if payload.battery_mv is not None else []
    return '; '.join([*parts, *(_record(record) for record in payload.records)])


def _record(record: Record) -> str:
    if isinstance(record, RssiRecord):
        sigma = '' if record.sigma_db is None else f' +- {record.sigma_db:g}'
        age, beacon = _or(record.age_ms), _or(record.beacon_seq)
        return f'{record.robot_id}: {_or(record.rssi_dbm)}{sigma} dBm n {record.n_samples} age {age} ms beacon {beacon}'
    if isinstance(record, RangeRecord):
        age, beacon = _or(record.age_ms), _or(record.beacon_seq)
        return f'{record.robot_id}: {record.range_mm} +- {record.sigma_mm} mm age {age} ms beacon {beacon}'
    if isinstance(record, FeedbackRecord):
        return f'{record.robot_id}: ({record.x:.2f}, {record.y:.2f}) m ({record.vx:.2f}, {record.vy:.2f}) m/s'
    active = 'measure' if record.active else 'rest'
    return f'{record.node_id}: {active}, y_min {record.y_min} dBm, e {record.e_min:.2f} to {record.e_max:.2f} dB'


def _value(name: str, value: Any) -> str:
    if isinstance(value, bytes):
        return value.hex() or '-'
    if isinstance(value, tuple):
        if value and hasattr(value[0], '_asdict'):
            return '[' + ', '.join(f'({describe_command(item)})' for item in value) + ']'
        return '[' + ' '.join(_value(name, item) for item in value) + ']'
    return f'{value:0{HEX[name]}X}' if name in HEX else str(value)


def _or(value: int | None) -> str:
    return '?' if value is None else str(value)
