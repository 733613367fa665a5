"""Serve advised feeds over REST, and the dashboard.

examples:
  stepnc serve
  stepnc serve --data /srv/stepnc --workers 2
  stepnc serve --agent vmc15=http://192.168.0.7:5000/vmc15
  stepnc serve --database postgresql://stepnc@db.shop/stepnc --files /mnt/stepnc
  stepnc serve --host 0.0.0.0 --name planner.shop --tls-cert shop.crt --tls-key shop.key

Serve the REST API and the dashboard. API keys are required unless the service listens on this
computer's loopback address only: see `stepnc keys create`.
"""
