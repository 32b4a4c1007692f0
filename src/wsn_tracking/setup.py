"""Installs wsn_tracking: the package, its executables, its launch, configuration and RViz files."""

from pathlib import Path

from setuptools import find_packages, setup

NAME = 'wsn_tracking'
SHARED = {'launch': '*.launch.py', 'config': '*.yaml', 'rviz': '*.rviz'}


def files(folder, pattern):
    """Files of a folder beside this one; a symlinked build runs among links, some of them dangling."""
    return sorted(path for path in Path(folder).glob(pattern) if path.is_file())


NODES = [path.stem for pattern in ('*_node.py', '*_simulator.py') for path in files(f'{NAME}/nodes', pattern)]

setup(
    name=NAME,
    version='0.1.0',
    description='Tracks moving targets with a wireless sensor network',
    license='Apache-2.0',
    packages=find_packages(include=[NAME, f'{NAME}.*']),
    package_data={NAME: ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        *(
            (f'share/{NAME}/{folder}', [str(path) for path in files(folder, pattern)])
            for folder, pattern in SHARED.items()
        ),
    ],
    # Each file nodes/*_node.py or nodes/*_simulator.py is an executable of that name.
    entry_points={
        'console_scripts': [
            *(f'{node} = {NAME}.nodes.{node}:main' for node in NODES),
            f'wsn-tracking = {NAME}.cli:main',
        ]
    },
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},
    zip_safe=False,
)
